#version 450
// Before a substep's end, a thread a near pair.
#include "common.glsl"
#include "plane_buffers.glsl"
layout(std430, binding = BIND_PREDICTED) readonly buffer Proposed { vec4 y[]; };
layout(std430, binding = BIND_STARTS) readonly buffer Starts { vec4 starts[]; };
layout(std430, binding = BIND_LEDGER) readonly buffer Ledger { ContactLedger ledger; };
layout(std430, binding = BIND_PAIRS) readonly buffer Pairs { uvec4 pairs[]; };
layout(std430, binding = BIND_TOUCHED) writeonly buffer Touched { uint touched[]; };
layout(std430, binding = BIND_PAIR_STATES) buffer States { PairState states[]; };
#include "plane_geometry.glsl"
#include "plane_choose.glsl"

void main() {
  begin_substep(p.first_substep);
  for (uint n = item(); n < ledger.asked[1]; n += stride()) choose(pairs[n].w);
}

#version 450
// Twice a substep, a thread a near pair.
#include "common.glsl"
#include "plane_buffers.glsl"
layout(std430, binding = BIND_PREDICTED) readonly buffer Proposed { vec4 y[]; };
layout(std430, binding = BIND_STARTS) readonly buffer Starts { vec4 starts[]; };
layout(std430, binding = BIND_LEDGER) readonly buffer Ledger { ContactLedger ledger; };
layout(std430, binding = BIND_PAIRS) buffer Pairs { uvec4 pairs[]; };
layout(std430, binding = BIND_NEAR_BITS) buffer NearBits { uint near_bits[]; };
layout(std430, binding = BIND_TOUCHED) writeonly buffer Touched { uint touched[]; };
layout(std430, binding = BIND_PAIR_STATES) buffer States { PairState states[]; };
layout(std430, binding = BIND_FAULTS) buffer Faults { ContactFaults faults; };
#include "plane_geometry.glsl"
#include "plane_push.glsl"
#include "plane_query.glsl"

void main() {
  turn = p.turn;
  begin_substep(p.first_substep);
  for (uint n = item(); n < ledger.asked[min(turn, 1u)]; n += stride()) ask(pairs[n].w);
}

#version 450
// Before a substep's end, a thread a near pair of triangles of the cloth.
#include "common.glsl"
#include "plane_buffers.glsl"
layout(std430, binding = BIND_PREDICTED) readonly buffer Proposed { vec4 y[]; };
layout(std430, binding = BIND_STARTS) readonly buffer Starts { vec4 starts[]; };
layout(std430, binding = BIND_LEDGER) readonly buffer Ledger { ContactLedger ledger; };
layout(std430, binding = BIND_SELF_NEAR) buffer SelfNears { SelfNear self_near[]; };
#include "plane_self_choose.glsl"

void main() {
  uint count = min(ledger.self_near, NEAR_CAPACITY);
  for (uint k = item(); k < count; k += stride()) choose_self(k);
}

#version 450
// After the lines, a thread a near pair: nearest points at the substep's start, and what contacts there propose.
#include "common.glsl"
#include "plane_buffers.glsl"
layout(std430, binding = BIND_PREDICTED) readonly buffer Proposed { vec4 y[]; };
layout(std430, binding = BIND_STARTS) readonly buffer Starts { vec4 starts[]; };
layout(std430, binding = BIND_FANS) readonly buffer Fans { uint fans[]; };
layout(std430, binding = BIND_LEDGER) buffer Ledger { ContactLedger ledger; };
layout(std430, binding = BIND_SELF_PAIRS) writeonly buffer SelfPairs { SelfPair self_pairs[]; };
layout(std430, binding = BIND_SELF_NEAR) buffer SelfNears { SelfNear self_near[]; };
layout(std430, binding = BIND_SELF_CONTACTS) buffer SelfContacts { SelfContact self_contacts[]; };
layout(std430, binding = BIND_SELF_PUSHES) writeonly buffer SelfPushes { SelfPush self_pushes[]; };
layout(std430, binding = BIND_FAULTS) buffer Faults { ContactFaults faults; };
#include "plane_geometry.glsl"
#include "plane_self_push.glsl"
#include "plane_self_query.glsl"

void main() {
  turn = p.turn;
  uint count = min(ledger.self_near, NEAR_CAPACITY);
  for (uint k = item(); k < count; k += stride()) {
    query_self(k);
    push_self(k);
  }
}

#version 450
// A further round of responses, a thread a near pair of triangles of the cloth.
#include "common.glsl"
#include "plane_buffers.glsl"
layout(std430, binding = BIND_PREDICTED) readonly buffer Proposed { vec4 y[]; };
layout(std430, binding = BIND_STARTS) readonly buffer Starts { vec4 starts[]; };
layout(std430, binding = BIND_LEDGER) readonly buffer Ledger { ContactLedger ledger; };
layout(std430, binding = BIND_SELF_NEAR) readonly buffer SelfNears { SelfNear self_near[]; };
layout(std430, binding = BIND_SELF_CONTACTS) readonly buffer SelfContacts { SelfContact self_contacts[]; };
layout(std430, binding = BIND_SELF_PUSHES) writeonly buffer SelfPushes { SelfPush self_pushes[]; };
#include "plane_self_push.glsl"

void main() {
  turn = p.turn;
  uint count = min(ledger.self_near, NEAR_CAPACITY);
  for (uint k = item(); k < count; k += stride()) push_self(k);
}

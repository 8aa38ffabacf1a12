#version 450
// A further round of responses, a thread a near pair of triangles of the cloth.
#include "common.glsl"
#include "plane_buffers.glsl"
#include "plane_self_push.glsl"

void main() {
  turn = p.turn;
  uint count = min(ledger.self_near, NEAR_CAPACITY);
  for (uint k = item(); k < count; k += stride()) push_self(k);
}

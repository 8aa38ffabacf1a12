#version 450
// Twice a substep, a thread a near pair.
#include "common.glsl"
#include "plane_buffers.glsl"
#include "plane_geometry.glsl"
#include "plane_push.glsl"
#include "plane_query.glsl"

void main() {
  turn = p.turn;
  begin_substep(p.first_substep);
  for (uint n = item(); n < ledger.asked[min(turn, 1u)]; n += stride()) ask(pairs[n].w);
}

#version 450
// Once a substep, with what moves twice; a thread a pair.
#include "common.glsl"
#include "plane_buffers.glsl"
#include "plane_geometry.glsl"
#define NEAR_COUNT ledger.asked[min(turn, 1u)]
#include "plane_near.glsl"

void main() {
  turn = p.turn;
  begin_substep(p.first_substep);
  if (item() == 0u && turn > 0u) ledger.asked[0] = 0u;
  for (uint k = item(); k < ledger.pairs; k += stride())
    if (may_be_near(k) && is_near(k)) list_near(k, atomicAdd(NEAR_COUNT, 1u));
}

#version 450
// After the lines, a thread a vertex.
#include "common.glsl"
#include "plane_buffers.glsl"
#include "plane_vertices.glsl"

void main() {
  uint i = item();
  turn = p.turn;
  begin_substep(p.first_substep);
  if (i < VERTICES) settle(i, LOAD16(x, i));
  if (i == 0u && turn == 1u && p.first_substep == 0u) ledger.farthest = 0u;  // until here of the last frame
  if (PIECES > 0u && (!AGAIN || turn < 2u)) forget_near(i, stride());
}

#version 450
// A further round of responses, a thread a near pair: the proposed corrections of contacts at the vertices' new places.
#include "common.glsl"
#include "plane_buffers.glsl"
ContactPiece piece;
#include "plane_push.glsl"
#include "plane_respond.glsl"

void main() {
  turn = p.turn;
  for (uint n = item(); n < ledger.asked[1]; n += stride()) respond(pairs[n].w);
}

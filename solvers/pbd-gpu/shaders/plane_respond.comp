#version 450
// A further round of responses, a thread a near pair: the proposed corrections of contacts at the vertices' new places.
#include "common.glsl"
#include "plane_buffers.glsl"
layout(std430, binding = BIND_PREDICTED) readonly buffer Proposed { vec4 y[]; };
layout(std430, binding = BIND_STARTS) readonly buffer Starts { vec4 starts[]; };
layout(std430, binding = BIND_LEDGER) readonly buffer Ledger { ContactLedger ledger; };
layout(std430, binding = BIND_PAIRS) readonly buffer Pairs { uvec4 pairs[]; };
layout(std430, binding = BIND_NEAR_BITS) buffer NearBits { uint near_bits[]; };
layout(std430, binding = BIND_TOUCHED) writeonly buffer Touched { uint touched[]; };
layout(std430, binding = BIND_PAIR_STATES) buffer States { PairState states[]; };
ContactPiece piece;
#include "plane_push.glsl"
#include "plane_respond.glsl"

void main() {
  turn = p.turn;
  for (uint n = item(); n < ledger.asked[1]; n += stride()) respond(pairs[n].w);
}

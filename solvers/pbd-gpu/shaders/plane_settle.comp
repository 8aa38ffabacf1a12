#version 450
// After the lines, a thread a vertex.
#include "common.glsl"
#include "plane_buffers.glsl"
layout(std430, binding = BIND_POSITIONS) readonly buffer Positions { vec4 x[]; };
layout(std430, binding = BIND_VELOCITIES) buffer Velocities { vec4 v[]; };
layout(std430, binding = BIND_PREDICTED) buffer Proposed { vec4 y[]; };
layout(std430, binding = BIND_STARTS) buffer Starts { vec4 starts[]; };
layout(std430, binding = BIND_REACHES) readonly buffer Reaches { vec4 reaches[]; };
layout(std430, binding = BIND_LEDGER) buffer Ledger { ContactLedger ledger; };
layout(std430, binding = BIND_NEAR_BITS) writeonly buffer NearBits { uint near_bits[]; };
#define SETTLE_ALONE
#include "plane_vertices.glsl"

void main() {
  uint i = item();
  turn = p.turn;
  begin_substep(p.first_substep);
  if (i < VERTICES) settle(i, LOAD16(x, i));
  if (i == 0u && turn == 1u && p.first_substep == 0u) ledger.farthest = 0u;  // until here of the last frame
  if (PIECES > 0u && (!AGAIN || turn < 2u)) forget_near(i, stride());
}

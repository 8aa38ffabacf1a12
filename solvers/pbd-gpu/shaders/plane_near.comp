#version 450
// Once a substep, with what moves twice; a thread a pair.
#include "common.glsl"
#include "plane_buffers.glsl"
layout(std430, binding = BIND_STARTS) readonly buffer Starts { vec4 starts[]; };
layout(std430, binding = BIND_WAYS) readonly buffer Ways { float ways[]; };
layout(std430, binding = BIND_LEDGER) buffer Ledger { ContactLedger ledger; };
layout(std430, binding = BIND_PAIRS) buffer Pairs { uvec4 pairs[]; };
layout(std430, binding = BIND_NEAR_BITS) buffer NearBits { uint near_bits[]; };
layout(std430, binding = BIND_PAIR_STATES) buffer States { PairState states[]; };
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

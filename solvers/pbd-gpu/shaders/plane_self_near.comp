#version 450
// Twice a substep, a thread a triangle.
#extension GL_GOOGLE_include_directive : require
#include "common.glsl"
#include "plane_buffers.glsl"
layout(std430, binding = BIND_SELF_WAYS) readonly buffer SelfWays { vec4 self_ways[]; };
layout(std430, binding = BIND_SELF_RANGES) buffer SelfRanges { uvec4 self_ranges[]; };
layout(std430, binding = BIND_SELF_PAIRS) buffer SelfPairs { SelfPair self_pairs[]; };
layout(std430, binding = BIND_SELF_NEAR) buffer SelfNears { SelfNear self_near[]; };
layout(std430, binding = BIND_LEDGER) buffer Ledger { ContactLedger ledger; };
layout(std430, binding = BIND_FAULTS) buffer Faults { ContactFaults faults; };
#include "plane_self_near.glsl"

void main() {
  turn = p.turn;
  if (item() == 0u) ledger.self_near[turn == 0u ? 1u : 0u] = ledger.self_touching[turn == 0u ? 1u : 0u] = 0u;
  for (uint t = item(); t < TRIANGLES; t += stride()) collect_near(t);
}

#version 450
// After the lines, a thread a triangle; SHUFFLES: a subgroup a triangle.
#include "common.glsl"
#include "plane_buffers.glsl"
layout(std430, binding = BIND_SELF_WAYS) readonly buffer SelfWays { vec4 self_ways[]; };
layout(std430, binding = BIND_SELF_RANGES) buffer SelfRanges { uvec4 self_ranges[]; };
layout(std430, binding = BIND_SELF_PAIRS) buffer SelfPairs { SelfPair self_pairs[]; };
layout(std430, binding = BIND_SELF_NEAR) writeonly buffer SelfNears { SelfNear self_near[]; };
layout(std430, binding = BIND_LEDGER) buffer Ledger { ContactLedger ledger; };
layout(std430, binding = BIND_FAULTS) buffer Faults { ContactFaults faults; };
#include "plane_self_near.glsl"

void main() {
  EACH_SHARED(t, TRIANGLES, collect_near(t);)
}

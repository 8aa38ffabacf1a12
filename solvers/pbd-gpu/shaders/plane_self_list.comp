#version 450
// Start of a frame, a thread a triangle (SHUFFLES: a subgroup): counts its pairs with others of the cloth; FILL writes them.
#include "common.glsl"
#include "plane_buffers.glsl"
layout(std430, binding = BIND_SELF_ORDER) readonly buffer SelfOrder { uint self_order[]; };
layout(std430, binding = BIND_SELF_BOXES) readonly buffer SelfBoxes { SelfBox self_boxes[]; };
#ifdef FILL
layout(std430, binding = BIND_SELF_RANGES) readonly buffer SelfRanges { uvec4 self_ranges[]; };
layout(std430, binding = BIND_LEDGER) readonly buffer Ledger { ContactLedger ledger; };
layout(std430, binding = BIND_SELF_PAIRS) writeonly buffer SelfPairs { SelfPair self_pairs[]; };
#define FILL_ALONE
#else
layout(std430, binding = BIND_SELF_RANGES) writeonly buffer SelfRanges { uvec4 self_ranges[]; };
#define COUNT_ALONE
#endif
#include "plane_self_list.glsl"

void main() {
#ifdef FILL
  EACH_SHARED(q, TRIANGLES, fill_self_pairs_of(q);)
#else
  EACH_SHARED(q, TRIANGLES, count_self_pairs_of(q);)
#endif
}

#version 450
// Start of a frame, a thread an element: counts its pairs; FILL writes them, and what they touch.
#include "common.glsl"
#include "plane_buffers.glsl"
layout(std430, binding = BIND_REACHES) readonly buffer Reaches { vec4 reaches[]; };
#ifdef FILL
layout(std430, binding = BIND_RANGES) readonly buffer Ranges { uvec4 ranges[]; };
layout(std430, binding = BIND_FANS) readonly buffer Fans { uint fans[]; };
layout(std430, binding = BIND_LEDGER) buffer Ledger { ContactLedger ledger; };
layout(std430, binding = BIND_TOUCHED) writeonly buffer Touched { uint touched[]; };
layout(std430, binding = BIND_PAIRS) writeonly buffer Pairs { uvec4 pairs[]; };
layout(std430, binding = BIND_PAIR_STATES) writeonly buffer States { PairState states[]; };
#define FILL_ALONE
#else
layout(std430, binding = BIND_RANGES) writeonly buffer Ranges { uvec4 ranges[]; };
layout(std430, binding = BIND_LEDGER) readonly buffer Ledger { ContactLedger ledger; };
#define COUNT_ALONE
#endif
#include "plane_list.glsl"

void main() {
  for (uint k = item(); k < TRIANGLES + VERTICES; k += stride()) {
#ifdef FILL
    uvec4 range = LOAD16(ranges, k);
    fill_pairs(k, ledger.reach, range.x, range.y);
#else
    uvec4 n = uvec4(pairs_at(k, 1.0), 0u, 0u, 0u);
    [[unroll]] for (uint l = 1u; l < PAIR_LEVELS; ++l)
      if (n[l - 1u] != 0u) n[l] = pairs_at(k, 1.0 / float(1u << CUT_BITS * l));
    STORE16(ranges, k, n);
#endif
  }
#ifdef FILL
  for (uint i = item(); i < VERTICES; i += stride()) list_touched(i);
#endif
}

#version 450
// Start of a frame, a thread an element: counts its pairs; FILL writes them, and what they touch.
#include "common.glsl"
#include "plane_buffers.glsl"
#include "plane_list.glsl"

void main() {
  for (uint k = item(); k < TRIANGLES + VERTICES; k += stride()) {
    if (FILL) {
      uvec4 range = LOAD16(ranges, k);
      fill_pairs(k, ledger.reach, range.x, range.y);
      continue;
    }
    uvec4 n = uvec4(pairs_at(k, 1.0), 0u, 0u, 0u);
    [[unroll]] for (uint l = 1u; l < PAIR_LEVELS; ++l)
      if (n[l - 1u] != 0u) n[l] = pairs_at(k, 1.0 / float(1u << CUT_BITS * l));
    STORE16(ranges, k, n);
  }
  for (uint i = item(); FILL && i < VERTICES; i += stride()) list_touched(i);
}

#version 450
// Candidate pairs, once per frame: counts the pairs of a primitive; FILL writes them, and the vertices that they touch.
// One thread per primitive.
#include "xpbd/contact/contact_buffers.glsl"
#include "xpbd/contact/broad_phase/contact_broad_phase.glsl"

void main() {
  for (uint k = item(); k < TRIANGLES + VERTICES; k += stride()) {
    if (FILL) {
      uvec4 range = ranges[k];
      fill_pairs(k, frame_state.bound_fraction, range.x, range.y);
      continue;
    }
    uvec4 n = uvec4(pairs_at(k, 1.0), 0u, 0u, 0u);
    [[unroll]] for (uint l = 1u; l < PAIR_LEVELS; ++l)
      if (n[l - 1u] != 0u) n[l] = pairs_at(k, 1.0 / float(1u << CUT_BITS * l));
    ranges[k] = n;
  }
  for (uint i = item(); FILL && i < VERTICES; i += stride()) list_touched_vertices(i);
}

// Pairs of triangles of the cloth without a common vertex whose boxes meet, each listed with both of its triangles. A box at a share of
// the reaches lies between those at rest and at the whole reaches. Counted for several shares, then written, as plane_list.glsl does.
const float kBelow = 0.9999;  // so that rounding makes no bound too great
bool share_vertex(uvec4 a, uvec4 b) {
  for (uint c = 0u; c < 3u; ++c)
    if (a[c] == b.x || a[c] == b.y || a[c] == b.z) return true;
  return false;
}

#include "self_box.glsl"
bool boxes_meet(SelfBox a, SelfBox b, float share) {
  return all(lessThanEqual(low_at(a, share), high_at(b, share))) && all(lessThanEqual(low_at(b, share), high_at(a, share)));
}

#ifndef COUNT_ALONE
/// Of two triangles from their boxes at the frame's start.
float least_distance(SelfBox a, SelfBox b) {
  vec3 apart = max(a.low_0.xyz - b.high_0.xyz, b.low_0.xyz - a.high_0.xyz) + THICKNESS_M;
  return kBelow * length(max(apart, 0.0));
}

void fill_self_pairs_of(uint place) {
  uint own = LOAD4(self_order, place);
  uvec4 range = LOAD16(self_ranges, own), e = LOAD16(elements, own);
  SelfBox box = LOAD(64u, self_boxes, place);
  uint at = range.x, end = range.x + range.y;
  for (uint g = 0u; g * PIECES_A_GROUP < TRIANGLES && at < end; ++g) {
    if (!boxes_meet(box, LOAD(64u, self_boxes, TRIANGLES + g), 1.0)) continue;
    for (uint q = PIECES_A_GROUP * g; q < min(PIECES_A_GROUP * (g + 1u), TRIANGLES) && at < end; ++q) {
      if (!boxes_meet(box, LOAD(64u, self_boxes, q), ledger.self_reach)) continue;
      uint other = LOAD4(self_order, q);
      if (share_vertex(e, LOAD16(elements, other))) continue;
      self_pairs[at++] = SelfPair(other, least_distance(box, LOAD(64u, self_boxes, q)));
    }
  }
}
#endif

#ifndef FILL_ALONE
void count_self_pairs_of(uint place) {
  uint own = LOAD4(self_order, place);
  uvec4 e = LOAD16(elements, own), n = uvec4(0u);
  SelfBox box = LOAD(64u, self_boxes, place);
  for (uint g = 0u; g * PIECES_A_GROUP < TRIANGLES; ++g) {
    if (!boxes_meet(box, LOAD(64u, self_boxes, TRIANGLES + g), 1.0)) continue;
    for (uint q = PIECES_A_GROUP * g; q < min(PIECES_A_GROUP * (g + 1u), TRIANGLES); ++q) {
      SelfBox other = LOAD(64u, self_boxes, q);
      if (!boxes_meet(box, other, 1.0) || share_vertex(e, LOAD16(elements, LOAD4(self_order, q)))) continue;
      float share = 1.0;
      for (uint l = 0u; l < PAIR_LEVELS && boxes_meet(box, other, share); ++l, share /= float(1u << CUT_BITS)) ++n[l];
    }
  }
  STORE16(self_ranges, own, n);
}
#endif

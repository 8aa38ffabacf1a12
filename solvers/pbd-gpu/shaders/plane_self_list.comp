#version 450
// Start of a frame, a subgroup a triangle: counts its pairs with others of the cloth; FILL writes them.
#define SUBGROUPS
#include "common.glsl"
#include "plane_buffers.glsl"
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

#include "self_share.glsl"
// Triangles in groups that meet the box, a few at a time: `q` is this thread's, and `mine` says whether its box meets the other at the
// share. All threads that share a triangle come along.
#define EACH_NEIGHBOURS(BOX, SHARE, BODY)                                                                                     \
  for (uint begin = 0u; begin * PIECES_A_GROUP < TRIANGLES; begin += sharers()) {                                             \
    uint g = begin + sharer();                                                                                                \
    bool meets_group = sharer() < sharers() && g * PIECES_A_GROUP < TRIANGLES;                                                \
    if (meets_group) meets_group = boxes_meet(BOX, LOAD(64u, self_boxes, TRIANGLES + g), 1.0);                                \
    for (uint groups = votes(meets_group); groups != 0u; groups &= groups - 1u) {                                             \
      uint first = PIECES_A_GROUP * (begin + uint(findLSB(groups))), last = min(first + PIECES_A_GROUP, TRIANGLES);           \
      for (uint part = first; part < last; part += sharers()) {                                                               \
        uint q = part + sharer();                                                                                             \
        bool mine = sharer() < sharers() && q < last;                                                                         \
        if (mine) mine = boxes_meet(BOX, LOAD(64u, self_boxes, q), SHARE);                                                    \
        BODY                                                                                                                  \
      }                                                                                                                       \
    }                                                                                                                         \
  }

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
  EACH_NEIGHBOURS(box, ledger.self_reach,
    uint other = mine ? LOAD4(self_order, q) : 0u;
    mine = mine && !share_vertex(e, LOAD16(elements, other));
    uint bits = votes(mine);
    uint to = at + uint(bitCount(bits & ((1u << sharer()) - 1u)));
    if (mine && to < end) self_pairs[to] = SelfPair(other, least_distance(box, LOAD(64u, self_boxes, q)));
    at += uint(bitCount(bits));
  )
}

void count_self_pairs_of(uint place) {
  uint own = LOAD4(self_order, place);
  uvec4 e = LOAD16(elements, own), n = uvec4(0u);
  SelfBox box = LOAD(64u, self_boxes, place);
  EACH_NEIGHBOURS(box, 1.0,
    if (mine && !share_vertex(e, LOAD16(elements, LOAD4(self_order, q)))) {
      SelfBox other = LOAD(64u, self_boxes, q);
      float share = 1.0;
      for (uint l = 0u; l < PAIR_LEVELS && boxes_meet(box, other, share); ++l) {
        ++n[l];
        share /= float(1u << CUT_BITS);
      }
    }
  )
  n = sum_of_sharers(n);
  if (sharer() == 0u) STORE16(self_ranges, own, n);
}

void main() {
  if (FILL) {
    EACH_SHARED(q, TRIANGLES, fill_self_pairs_of(q);)
  } else {
    EACH_SHARED(q, TRIANGLES, count_self_pairs_of(q);)
  }
}

// Candidate pairs of self-contact: cloth triangles without a common vertex whose boxes, inflated by a fraction of the
// motion bounds, overlap. Each pair is stored twice, once per triangle. Once per list and fraction, one subgroup per
// triangle.
const float kRoundingFactor = 0.9999;  // keeps a rounded distance below the exact one
bool share_a_vertex(uvec4 a, uvec4 b) {
  for (uint c = 0u; c < 3u; ++c)
    if (a[c] == b.x || a[c] == b.y || a[c] == b.z) return true;
  return false;
}

#include "xpbd/contact/broad_phase/self_aabb.glsl"
bool aabbs_overlap(SelfAabb a, SelfAabb b, float fraction) {
  return all(lessThanEqual(low_at(a, fraction), high_at(b, fraction))) &&
         all(lessThanEqual(low_at(b, fraction), high_at(a, fraction)));
}

#include "xpbd/contact/lanes_per_triangle.glsl"
// Runs BODY for the triangles of all groups that overlap BOX, one per lane at a time. `q` is the index of this lane's
// triangle in self_order, `mine` whether its box overlaps BOX at fraction SHARE. Control flow is subgroup-uniform.
#define FOR_EACH_NEIGHBOUR(BOX, SHARE, BODY) \
  for (uint begin = 0u; begin * TRIANGLES_PER_GROUP < TRIANGLES; begin += lanes_per_triangle()) { \
    uint g = begin + triangle_lane(); \
    bool overlaps_group = triangle_lane() < lanes_per_triangle() && g * TRIANGLES_PER_GROUP < TRIANGLES; \
    if (overlaps_group) overlaps_group = aabbs_overlap(BOX, self_aabbs[TRIANGLES + g], 1.0); \
    for (uint groups = ballot_bits(overlaps_group); groups != 0u; groups &= groups - 1u) { \
      uint first = TRIANGLES_PER_GROUP * (begin + uint(findLSB(groups))); \
      uint last = min(first + TRIANGLES_PER_GROUP, TRIANGLES); \
      for (uint part = first; part < last; part += lanes_per_triangle()) { \
        uint q = part + triangle_lane(); \
        bool mine = triangle_lane() < lanes_per_triangle() && q < last; \
        if (mine) mine = aabbs_overlap(BOX, self_aabbs[q], SHARE); \
        BODY \
      } \
    } \
  }

/// Lower bound on the distance of two triangles at the frame's start: the distance of their boxes before inflation.
float min_distance(SelfAabb a, SelfAabb b) {
  vec3 apart = max(a.low_0.xyz - b.high_0.xyz, b.low_0.xyz - a.high_0.xyz) + (THICKNESS_M + 2.0 * drift_m());
  return kRoundingFactor * length(max(apart, 0.0));
}

void list_self_pairs_of(uint slot) {
  uint own = self_order[slot], n = 0u;
  uvec4 e = primitives[own];
  SelfAabb box = self_aabbs[slot];
  FOR_EACH_NEIGHBOUR(box, kFractions[p.level],
    if (mine && !share_a_vertex(e, primitives[self_order[q]])) ++n;
  )
  n = sum_over_lanes(n);
  uint at = 0u;
  if (triangle_lane() == 0u) at = min(atomicAdd(frame_state.self_counted[p.level], n), SELF_CAPACITY);
  at = from_first_lane(at);
  uint end = at + min(n, SELF_CAPACITY - at);
  if (triangle_lane() == 0u) self_ranges[own] = uvec4(at, end - at, 0u, 0u);
  FOR_EACH_NEIGHBOUR(box, kFractions[p.level],
    uint other = mine ? self_order[q] : 0u;
    mine = mine && !share_a_vertex(e, primitives[other]);
    uint bits = ballot_bits(mine);
    uint to = at + uint(bitCount(bits & ((1u << triangle_lane()) - 1u)));
    if (mine && to < end) self_pairs[to] = SelfPair(other, min_distance(box, self_aabbs[q]));
    at += uint(bitCount(bits));
  )
}

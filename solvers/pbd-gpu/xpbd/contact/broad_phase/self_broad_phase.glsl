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
/// Bit mask of the lanes whose box of self_aabbs, from `first` on and before `end`, overlaps `box` at fraction 1.
uint overlapping(SelfAabb box, uint first, uint end) {
  uint n = first + triangle_lane();
  bool overlaps = triangle_lane() < lanes_per_triangle() && n < end;
  if (overlaps) overlaps = aabbs_overlap(box, self_aabbs[n], 1.0);
  return ballot_bits(overlaps);
}
const uint kGroupsPerBlock = BLOCK_TRIANGLES / SHAPES_PER_GROUP, kFirstBlock = TRIANGLES + kSelfGroups,
           kBlocks = (TRIANGLES + BLOCK_TRIANGLES - 1u) / BLOCK_TRIANGLES;

// Runs BODY for the triangles of all groups that overlap BOX, in all blocks that do, one per lane at a time. `q` is the
// index of this lane's triangle in self_order, `mine` whether its box overlaps BOX at fraction SHARE. Control flow is
// subgroup-uniform.
#define FOR_EACH_NEIGHBOUR(BOX, SHARE, BODY) \
  for (uint block = 0u; block < kBlocks; block += lanes_per_triangle()) { \
    uint blocks = overlapping(BOX, kFirstBlock + block, kFirstBlock + kBlocks); \
    for (; blocks != 0u; blocks &= blocks - 1u) { \
      uint begin = kGroupsPerBlock * (block + uint(findLSB(blocks))); \
      uint last = min(begin + kGroupsPerBlock, kSelfGroups); \
      for (; begin < last; begin += lanes_per_triangle()) { \
        uint groups = overlapping(BOX, TRIANGLES + begin, TRIANGLES + last); \
        for (; groups != 0u; groups &= groups - 1u) { \
          uint first = SHAPES_PER_GROUP * (begin + uint(findLSB(groups))); \
          uint end = min(first + SHAPES_PER_GROUP, TRIANGLES); \
          for (; first < end; first += lanes_per_triangle()) { \
            uint q = first + triangle_lane(); \
            bool mine = triangle_lane() < lanes_per_triangle() && q < end; \
            if (mine) mine = aabbs_overlap(BOX, self_aabbs[q], SHARE); \
            BODY \
          } \
        } \
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
  uint limit = at + min(n, SELF_CAPACITY - at);
  if (triangle_lane() == 0u) self_ranges[own] = uvec4(at, limit - at, 0u, 0u);
  FOR_EACH_NEIGHBOUR(box, kFractions[p.level],
    uint other = mine ? self_order[q] : 0u;
    mine = mine && !share_a_vertex(e, primitives[other]);
    uint bits = ballot_bits(mine);
    uint to = at + uint(bitCount(bits & ((1u << triangle_lane()) - 1u)));
    if (mine && to < limit) self_pairs[to] = SelfPair(other, min_distance(box, self_aabbs[q]));
    at += uint(bitCount(bits));
  )
}

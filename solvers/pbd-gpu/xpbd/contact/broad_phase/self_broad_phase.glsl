// Candidate pairs of self-contact: cloth triangles without a common vertex whose boxes overlap. Each pair is stored
// twice, once per triangle. One subgroup per triangle.
const float kRoundingFactor = 0.9999;  // keeps a rounded distance below the exact one
bool share_a_vertex(uvec4 a, uvec4 b) {
  for (uint c = 0u; c < 3u; ++c)
    if (a[c] == b.x || a[c] == b.y || a[c] == b.z) return true;
  return false;
}

#include "xpbd/contact/broad_phase/atomic_aabb.glsl"
#include "xpbd/contact/broad_phase/self_aabb.glsl"
bool aabbs_overlap(SelfAabb a, SelfAabb b) {
  return all(lessThanEqual(low_at(a, p.level), high_at(b, p.level))) &&
         all(lessThanEqual(low_at(b, p.level), high_at(a, p.level)));
}

bool overlaps_supergroup(SelfAabb a, uint n) {
  vec3 low = low_at(a, p.level), high = high_at(a, p.level);
  for (uint c = 0u; c < 3u; ++c)
    if (ordered(low[c]) > self_supergroups[n].high[c] || self_supergroups[n].low[c] > ordered(high[c])) return false;
  return true;
}

#include "xpbd/contact/lanes_per_triangle.glsl"
const uint kGroups = (TRIANGLES + TRIANGLES_PER_GROUP - 1u) / TRIANGLES_PER_GROUP;
const uint kSupergroups = (kGroups + GROUPS_PER_SUPERGROUP - 1u) / GROUPS_PER_SUPERGROUP;
// Each lane tests OVERLAPS for one of the `count` indices `k` from FIRST on at a time. Runs BODY for each index `of` that
// overlaps, in all lanes.
#define FOR_EACH_OVERLAPPING(k, of, FIRST, COUNT, OVERLAPS, BODY) \
  for (uint k##_begin = FIRST, k##_end = (FIRST) + (COUNT); k##_begin < k##_end; k##_begin += lanes_per_triangle()) { \
    uint k = k##_begin + triangle_lane(); \
    bool k##_overlaps = triangle_lane() < lanes_per_triangle() && k < k##_end; \
    if (k##_overlaps) k##_overlaps = OVERLAPS; \
    for (uint k##_bits = ballot_bits(k##_overlaps); k##_bits != 0u; k##_bits &= k##_bits - 1u) { \
      uint of = k##_begin + uint(findLSB(k##_bits)); \
      BODY \
    } \
  }
// Runs BODY for the triangles of all groups that overlap BOX, one per lane at a time. `q` is the index of this lane's
// triangle in self_order, `mine` whether its box overlaps BOX. Control flow is subgroup-uniform.
#define FOR_EACH_NEIGHBOUR(BOX, BODY) \
  FOR_EACH_OVERLAPPING(s, supergroup, 0u, kSupergroups, overlaps_supergroup(BOX, s), \
    uint groups_before = GROUPS_PER_SUPERGROUP * supergroup; \
    FOR_EACH_OVERLAPPING(g, group, groups_before, min(GROUPS_PER_SUPERGROUP, kGroups - groups_before), \
                         aabbs_overlap(BOX, self_aabbs[TRIANGLES + g]), \
      uint first = TRIANGLES_PER_GROUP * group; \
      uint last = min(first + TRIANGLES_PER_GROUP, TRIANGLES); \
      for (uint part = first; part < last; part += lanes_per_triangle()) { \
        uint q = part + triangle_lane(); \
        bool mine = triangle_lane() < lanes_per_triangle() && q < last; \
        if (mine) mine = aabbs_overlap(BOX, self_aabbs[q]); \
        BODY \
      } \
    ) \
  )

/// Lower bound on the distance of two triangles at the substep's start: the distance of their boxes there.
float min_distance(SelfAabb a, SelfAabb b) {
  vec3 apart = max(a.low_0.xyz - b.high_0.xyz, b.low_0.xyz - a.high_0.xyz);
  return kRoundingFactor * length(max(apart, 0.0));
}

// Indices in self_order of a triangle's pairs: kKept per lane of its subgroup.
const uint kKept = 4u;
shared uint kept[kKept * gl_WorkGroupSize.x];

void write_self_pair(uint to, uint end, SelfAabb box, uint q) {
  if (to < end) self_pairs[to] = SelfPair(self_order[q], min_distance(box, self_aabbs[q]));
}

void list_self_pairs_of(uint slot) {
  uint own = self_order[slot], n = 0u, room = kKept * gl_SubgroupSize, first_kept = room * gl_SubgroupID;
  uvec4 e = primitives[own];
  SelfAabb box = self_aabbs[slot];
  subgroupBarrier();  // wait until the last triangle's pairs are read
  FOR_EACH_NEIGHBOUR(box,
    mine = mine && !share_a_vertex(e, primitives[self_order[q]]);
    uint bits = ballot_bits(mine);
    uint index = n + uint(bitCount(bits & ((1u << triangle_lane()) - 1u)));
    if (mine && index < room) kept[first_kept + index] = q;
    n += uint(bitCount(bits));
  )
  uint at = 0u;
  if (triangle_lane() == 0u) at = min(atomicAdd(frame_state.self_listed[p.level], n), SELF_CAPACITY);
  at = from_first_lane(at);
  uint end = at + min(n, SELF_CAPACITY - at);
  if (triangle_lane() == 0u) self_ranges[own] = uvec4(at, end - at, 0u, 0u);
  subgroupBarrier();  // wait for the pairs of all lanes
  if (n <= room) {
    for (uint k = triangle_lane(); k < n; k += gl_SubgroupSize) write_self_pair(at + k, end, box, kept[first_kept + k]);
    return;
  }
  FOR_EACH_NEIGHBOUR(box,
    mine = mine && !share_a_vertex(e, primitives[self_order[q]]);
    uint bits = ballot_bits(mine);
    uint index = uint(bitCount(bits & ((1u << triangle_lane()) - 1u)));
    if (mine) write_self_pair(at + index, end, box, q);
    at += uint(bitCount(bits));
  )
}

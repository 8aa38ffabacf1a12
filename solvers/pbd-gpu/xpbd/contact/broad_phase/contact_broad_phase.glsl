// Candidate pairs of a primitive and a convex shape: their boxes overlap after the primitive's box is inflated by the
// motion bounds of its vertices. The list is made with decreasing fractions of the bounds (kFractions) until it fits.
vec3 low, high;
void box_for(uvec4 e, float fraction) {
  low = vec3(1e30);
  high = vec3(-1e30);
  for (uint c = 0u; c < e.w; ++c) {
    vec4 r = motion_bounds[e[c]];
    low = min(low, r.xyz - fraction * r.w);
    high = max(high, r.xyz + fraction * r.w);
  }
}
#ifdef FUSED_FRAME
vec3 contact_free_low, contact_free_high;  // box of the primitive inflated by contact_free_bound()
void contact_free_aabb_for(uvec4 e) {
  contact_free_low = vec3(1e30);
  contact_free_high = vec3(-1e30);
  for (uint c = 0u; c < e.w; ++c) {
    vec4 r = starts[e[c]];
    contact_free_low = min(contact_free_low, r.xyz - r.w);
    contact_free_high = max(contact_free_high, r.xyz + r.w);
  }
}
bool overlaps_contact_free(ShapeAabb b) {
  return all(lessThanEqual(contact_free_low, b.high.xyz)) && all(lessThanEqual(b.low.xyz, contact_free_high));
}
#endif
bool aabb_overlaps(ShapeAabb b) {
  return all(lessThanEqual(low, b.high.xyz)) && all(lessThanEqual(b.low.xyz, high));
}

// A cluster of lanes (one thread outside the fused frame) tests boxes against one primitive. Each lane tests a few
// boxes at a time, so that their loads overlap. Control flow is subgroup-uniform.
#ifdef FUSED_FRAME
#define LANES_PER_PRIMITIVE LANES_PER_VERTEX
#define PRIMITIVE_LANE cluster_lane()
uint cluster_or(uint bits) {
  for (uint n = LANES_PER_VERTEX >> 1u; n > 0u; n >>= 1u) bits |= subgroupShuffleXor(bits, n);
  return bits;
}
#define ANY_IN_SUBGROUP(bits) (LANES_PER_VERTEX > 1u ? subgroupAny((bits) != 0u) : (bits) != 0u)
#else
#define LANES_PER_PRIMITIVE 1u
#define PRIMITIVE_LANE 0u
uint cluster_or(uint bits) { return bits; }
#define ANY_IN_SUBGROUP(bits) ((bits) != 0u)
#endif
const uint kAabbUnroll = 4u, kAabbsPerStep = kAabbUnroll * LANES_PER_PRIMITIVE;
/// Tests the next kAabbsPerStep convex shapes from `first` on, before `end`. Returns a bit for each whose box overlaps
/// the primitive's; `own`: only the bits that this lane tested.
uint overlapping_shapes(uint first, uint end, out uint own) {
  own = 0u;
  [[unroll]] for (uint n = 0u; n < kAabbUnroll; ++n) {
    uint of = n * LANES_PER_PRIMITIVE + PRIMITIVE_LANE;
    if (aabb_overlaps(boxes[min(first + of, SHAPES - 1u)]) && first + of < end) own |= 1u << of;
  }
  return cluster_or(own);
}

// One bit per group.
#define GROUP_WORDS ((GROUPS + 31u) / 32u)
#ifdef FUSED_FRAME
shared uint nearby_groups[GROUP_WORDS + 1u];
#define NEARBY_GROUPS(word) nearby_groups[word]
#else
#define NEARBY_GROUPS(word) ~0u
#endif
/// Tests the next few groups of `bits` and clears their bits. Returns the bits of groups that overlap the primitive.
uint overlapping_groups(inout uint bits, uint word) {
  uint overlapping = 0u, last = bits;
  for (uint n = 0u; n < kAabbsPerStep && last != 0u; ++n) last &= last - 1u;
  uint step_bits = bits ^ last;
  bits = last;
  for (uint n = 0u; n < PRIMITIVE_LANE; ++n) step_bits &= step_bits - 1u;
  [[unroll]] for (uint n = 0u; n < kAabbUnroll; ++n) {
    uint g = 32u * word + uint(findLSB(step_bits));
    if (step_bits != 0u && g < GROUPS && aabb_overlaps(boxes[SHAPES + g])) overlapping |= step_bits & -step_bits;
    for (uint k = 0u; k < LANES_PER_PRIMITIVE; ++k) step_bits &= step_bits - 1u;
  }
  return cluster_or(overlapping);
}
// Runs BODY for a few shapes at a time, from index `q` on. `overlapping` has a bit for each shape whose box overlaps
// the primitive's box; `own` has only the bits that this lane tested.
#define FOR_EACH_OVERLAPPING_SHAPES(BODY) \
  for (uint word = 0u; word < GROUP_WORDS; ++word) \
    for (uint bits = NEARBY_GROUPS(word); bits != 0u;) \
      for (uint groups = overlapping_groups(bits, word); ANY_IN_SUBGROUP(groups); groups &= groups - 1u) { \
        uint first = SHAPES_PER_GROUP * (32u * word + uint(max(findLSB(groups), 0))); \
        uint last = groups != 0u ? min(first + SHAPES_PER_GROUP, SHAPES) : 0u; \
        for (uint step = 0u; step < SHAPES_PER_GROUP; step += kAabbsPerStep) { \
          uint q = first + step, own, overlapping = overlapping_shapes(q, last, own); \
          BODY \
        } \
      }

void write_pair(uint at, uint primitive, uint of_shape) {
  pairs[at] = uvec4(primitive, of_shape, 0u, 0u);
  states[at].normal = vec4(0.0);
  states[at].correction = vec4(0.0);
}

/// Rank of the shape with bit `bit` among the overlapping shapes of a step.
uint slot_in(uint overlapping, uint bit) { return uint(bitCount(overlapping & ((1u << bit) - 1u))); }

/// Writes the first `count` pairs of primitive k to the list, from index `at` on.
void fill_pairs(uint k, float fraction, uint at, uint count) {
  box_for(primitives[k], fraction);
  uint end = at + count;
  FOR_EACH_OVERLAPPING_SHAPES(
    for (; own != 0u; own &= own - 1u) {
      uint bit = uint(findLSB(own));
      uint to = at + slot_in(overlapping, bit);
      if (to < end) write_pair(to, k, q + bit);
    }
    at += uint(bitCount(overlapping));
  )
}

/// Selects the largest fraction of the motion bounds at which all pairs fit into the list, or the smallest; then pairs
/// beyond the capacity are counted. Called by one thread.
void finish_broad_phase() {
  uint level = 0u;
  while (level + 1u < PAIR_LEVELS && frame_state.counted[level] > CAPACITY) ++level;
  if (frame_state.counted[level] > CAPACITY) diagnostics.overflow += frame_state.counted[level] - CAPACITY;
  frame_state.pairs = min(frame_state.counted[level], CAPACITY);
  frame_state.bound_fraction = kFractions[level];
}

/// Counts the candidate pairs of vertex i and its triangles; if any, adds i to the touched vertices, in no fixed order.
void list_touched_vertices(uint i) {
  uint pairs_of = ranges[TRIANGLES + i].y;
  for (uint f = vertex_triangles[i], end = vertex_triangles[i + 1u]; f < end; ++f)
    pairs_of += ranges[vertex_triangles[f] / 4u].y;
  touched[PAIR_COUNT(i)] = pairs_of;
  if (pairs_of == 0u) return;
  touched[atomicAdd(frame_state.touched_vertices, 1u)] = i;
}

/// Number of pairs of primitive k if its vertices move at most `fraction` of their motion bounds.
uint pairs_at(uint k, float fraction) {
  box_for(primitives[k], fraction);
  uint n = 0u;
  FOR_EACH_OVERLAPPING_SHAPES(n += uint(bitCount(overlapping));)
  return n;
}

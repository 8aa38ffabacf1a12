// Broad phase of fused_frame.comp: all workgroups build the frame's list of candidate pairs together.
#ifdef CONTACT_FREE
const bool kTestsContactFree = true;  // also tests whether a contact-free cloth can reach a shape
#else
const bool kTestsContactFree = false;
#endif
// Values of any_nearby, one per workgroup. In order: no group of shapes overlaps the cloth's motion bounds; a group
// does; a shape overlaps a primitive's box of a contact-free frame.
const uint kOutOfReach = 0u, kNearby = 1u, kOverlaps = 2u;
shared uint any_nearby;

/// Computes the motion bounds of all vertices, and the box of all positions that the cloth can reach in the frame.
void bound_and_grow(float max_shape_displacement) {
  uvec3 from = uvec3(kLowNone), to = uvec3(kHighNone);
  FOR_EACH_STRIDED(i, VERTICES) widen(from, to, motion_bound_of_vertex(i, max_shape_displacement));
  widen_box(from, to);
  barrier();  // wait for the workgroup's box before adding it to the box of all
  if (thread < 3u) {
    atomicMin(frame_state.cloth_low[thread], cloth_low[thread]);
    atomicMax(frame_state.cloth_high[thread], cloth_high[thread]);
  }
}

shared uint listed, first_listed;  // number of the workgroup's pairs, index of the first
const uint kKept = 16u;
/// Lists the pairs of all primitives at a fraction of the motion bounds, one cluster of lanes per primitive. The order
/// of primitives is not fixed; a primitive's pairs are in the order of convex shapes. Pairs beyond the capacity are
/// only counted.
void fill_at(float fraction, uint level) {
  for (uint base = (global_thread - thread) / LANES_PER_PRIMITIVE; base < TRIANGLES + VERTICES;
       base += grid_stride / LANES_PER_PRIMITIVE) {
    uint k = base + thread / LANES_PER_PRIMITIVE, n = 0u, mine = 0u;
    uvec2 kept[kKept];  // this lane's pairs: convex shape, index among the primitive's pairs
    bool valid = k < TRIANGLES + VERTICES, overlaps_it = false;
    if (thread == 0u) listed = 0u;
    low = vec3(1e30);
    high = vec3(-1e30);
    if (valid) {
      uvec4 e = primitives[k];
      box_for(e, fraction);
      if (kTestsContactFree) contact_free_aabb_for(e);
    }
    FOR_EACH_OVERLAPPING_SHAPES(
      for (; own != 0u; own &= own - 1u) {
        uint bit = uint(findLSB(own));
        if (mine < kKept) kept[mine] = uvec2(q + bit, n + slot_in(overlapping, bit));
        ++mine;
        if (kTestsContactFree && !overlaps_it) overlaps_it = overlaps_contact_free(boxes[q + bit]);
      }
      n += uint(bitCount(overlapping));
    )
    if (overlaps_it) any_nearby = kOverlaps;
    barrier();  // wait for listed = 0 before lanes add to it
    uint at = 0u;
    if (n > 0u && PRIMITIVE_LANE == 0u) at = atomicAdd(listed, n);
    at = FROM_LANE(at, 0u);
    barrier();  // wait for the workgroup's number of pairs before thread 0 reserves their range
    if (thread == 0u && listed > 0u) first_listed = atomicAdd(frame_state.counted[level], listed);
    barrier();  // wait for the range's start before lanes fill it
    at = min(first_listed + at, CAPACITY);
    uint room = min(n, CAPACITY - at);
    if (valid && PRIMITIVE_LANE == 0u) ranges[k] = uvec4(n > 0u ? at : 0u, room, 0u, 0u);
    if (ANY_IN_SUBGROUP(mine > kKept ? 1u : 0u))
      fill_pairs(min(k, TRIANGLES + VERTICES - 1u), fraction, at, room);
    else
      for (uint m = 0u; m < mine; ++m)
        if (kept[m].y < room) write_pair(at + kept[m].y, k, kept[m].x);
  }
}

/// Builds the frame's list of pairs. With kTestsContactFree, the list stays empty if slow cloth cannot reach a shape.
bool broad_phase() {
  bool may_be_contact_free = kTestsContactFree && is_slow();
  if (thread == 0u) any_nearby = kOutOfReach;
  for (uint word = thread; word < GROUP_WORDS; word += THREADS) nearby_groups[word] = 0u;
  empty_box();
  float max_shape_displacement = max_displacement_of_shapes();
  if (global_thread == 0u) {
    frame_state.max_shape_displacement = max_shape_displacement;
    frame_state.bound_fraction = 1.0;
    frame_state.pairs = frame_state.touched_vertices = frame_state.contact_possible = 0u;
    for (uint l = 0u; l < PAIR_LEVELS; ++l) frame_state.counted[l] = 0u;
  }
  GRID_BARRIER_OR_FAIL;  // wait for empty boxes before threads grow them
  bound_and_grow(max_shape_displacement);
  GRID_BARRIER_OR_FAIL;  // wait for motion bounds and the cloth's box before threads test against them
  if (global_thread == 0u) frame_state.max_displacement = 0u;  // resets the last frame's value
  for (uint g = thread; g < GROUPS; g += THREADS)
    if (overlaps_cloth(boxes[SHAPES + g])) {
      atomicOr(nearby_groups[g / 32u], 1u << g % 32u);
      any_nearby = kNearby;
    }
  barrier();  // wait for all groups' tests before threads read any_nearby
  if (SHAPES == 0u || (any_nearby == kOutOfReach && may_be_contact_free)) return true;
  uint level = 0u;
  for (;; ++level) {
    fill_at(kFractions[level], level);
    if (thread == 0u && any_nearby == kOverlaps) frame_state.contact_possible = 1u;
    GRID_BARRIER_OR_FAIL;  // wait for pairs and their number before threads read them
    if (may_be_contact_free && frame_state.contact_possible == 0u) return true;
    if (level + 1u == PAIR_LEVELS || frame_state.counted[level] <= CAPACITY) break;
  }
  if (global_thread == 0u) finish_broad_phase();
  FOR_EACH_STRIDED(i, VERTICES) list_touched_vertices(i);
  GRID_BARRIER_OR_FAIL;  // wait for the list and the touched vertices before threads read them
  return true;
}

// The list of a frame's pairs, by all workgroups of fused_frame.comp.
#ifdef CONTACT_FREE
const bool kTestsContactFree = true;  // whether the cloth's own speed may take it to a shape
#else
const bool kTestsContactFree = false;
#endif
// State of the workgroup's primitives in this frame.
// No group of convex shapes is within the motion bound; one is; one would meet the cloth without contact.
const uint kOutOfReach = 0u, kNearby = 1u, kOverlaps = 2u;
shared uint any_nearby;

/// Motion bounds of all vertices, and the box of everywhere that the cloth may go in the frame.
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

shared uint listed, first_listed;  // of the workgroup
const uint kKept = 16u;
/// Lists the pairs of all primitives at a fraction of the motion bounds, a cluster of lanes per primitive. Elements
/// have their places in no fixed order; a primitive's are in the order of convex shapes. Pairs beyond the
/// capacity are only counted.
void fill_at(float fraction, uint level) {
  for (uint base = (global_thread - thread) / LANES_PER_PRIMITIVE; base < TRIANGLES + VERTICES;
       base += grid_stride / LANES_PER_PRIMITIVE) {
    uint k = base + thread / LANES_PER_PRIMITIVE, n = 0u, mine = 0u;
    uvec2 kept[kKept];  // of this lane: convex shape, place among the primitive's
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
    barrier();  // before places in the workgroup's part are given
    uint at = 0u;
    if (n > 0u && PRIMITIVE_LANE == 0u) at = atomicAdd(listed, n);
    at = FROM_LANE(at, 0u);
    barrier();  // all places of the workgroup before its part is taken
    if (thread == 0u && listed > 0u) first_listed = atomicAdd(frame_state.counted[level], listed);
    barrier();  // the part's beginning before it is filled
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

/// The frame's list of pairs. With kTestsContactFree there is none where a slow cloth meets no convex shape.
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
  GRID_BARRIER_OR_FAIL;  // empty boxes before they are widened
  bound_and_grow(max_shape_displacement);
  GRID_BARRIER_OR_FAIL;  // motion bounds before the list
  if (global_thread == 0u) frame_state.max_displacement = 0u;  // until here of the last frame
  for (uint g = thread; g < GROUPS; g += THREADS)
    if (overlaps_cloth(boxes[SHAPES + g])) {
      atomicOr(nearby_groups[g / 32u], 1u << g % 32u);
      any_nearby = kNearby;
    }
  barrier();  // every thread's look before the answer
  if (SHAPES == 0u || (any_nearby == kOutOfReach && may_be_contact_free)) return true;
  uint level = 0u;
  for (;; ++level) {
    fill_at(kFractions[level], level);
    if (thread == 0u && any_nearby == kOverlaps) frame_state.contact_possible = 1u;
    GRID_BARRIER_OR_FAIL;  // pairs before they are read, and their number
    if (may_be_contact_free && frame_state.contact_possible == 0u) return true;
    if (level + 1u == PAIR_LEVELS || frame_state.counted[level] <= CAPACITY) break;
  }
  if (global_thread == 0u) finish_broad_phase();
  FOR_EACH_STRIDED(i, VERTICES) list_touched_vertices(i);
  GRID_BARRIER_OR_FAIL;  // the list before it is read
  return true;
}

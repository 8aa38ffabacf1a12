// The list of a frame's pairs, by all workgroups of plane_frame.comp.
#ifdef FAR
const bool kLooksForFar = true;  // whether the cloth meets a piece if nothing but its own speed takes it there
#else
const bool kLooksForFar = false;
#endif
// Of the workgroup's elements in this frame.
const uint kFar = 0u, kListed = 1u, kMeets = 2u;  // no group of pieces is in reach; one is; and would meet the cloth without contact
shared uint any_near;

/// Reaches of all vertices, and the box of everywhere that the cloth may go in the frame.
void reach_and_widen(float carried) {
  uvec3 from = uvec3(kLowNone), to = uvec3(kHighNone);
  EACH(i, VERTICES) widen(from, to, reach_of_vertex(i, carried));
  widen_box(from, to);
  barrier();  // the workgroup's box before that of all
  if (thread < 3u) {
    atomicMin(ledger.cloth_low[thread], cloth_low[thread]);
    atomicMax(ledger.cloth_high[thread], cloth_high[thread]);
  }
}

shared uint listed, first_listed;  // of the workgroup
const uint kKept = 16u;
/// Lists the pairs of all elements at a share of the reaches, a team an element. Elements have their places in no fixed order; the order
/// within an element's is that of pieces. What the list has no place for is counted alone.
void list_at(float share, uint level) {
  for (uint base = (me - thread) / LIST_TEAM; base < TRIANGLES + VERTICES; base += all_threads / LIST_TEAM) {
    uint k = base + thread / LIST_TEAM, n = 0u, mine = 0u;
    uvec2 kept[kKept];  // of this lane: piece, place among the element's
    bool valid = k < TRIANGLES + VERTICES, meets_it = false;
    if (thread == 0u) listed = 0u;
    low = vec3(1e30);
    high = vec3(-1e30);
    if (valid) {
      uvec4 e = LOAD16(elements, k);
      box_for(e, share);
      if (kLooksForFar) free_box_for(e);
    }
    EACH_PIECES_MET(
      for (; own != 0u; own &= own - 1u) {
        uint bit = uint(findLSB(own));
        if (mine < kKept) kept[mine] = uvec2(q + bit, n + place_in(met, bit));
        ++mine;
        if (kLooksForFar && !meets_it) meets_it = meets_freely(LOAD(32u, boxes, q + bit));
      }
      n += uint(bitCount(met));
    )
    if (meets_it) any_near = kMeets;
    barrier();  // before places in the workgroup's part are given
    uint at = 0u;
    if (n > 0u && LIST_LANE == 0u) at = atomicAdd(listed, n);
    at = FROM_LANE(at, 0u);
    barrier();  // all places of the workgroup before its part is taken
    if (thread == 0u && listed > 0u) first_listed = atomicAdd(ledger.counted[level], listed);
    barrier();  // the part's beginning before it is filled
    at = min(first_listed + at, CAPACITY);
    uint room = min(n, CAPACITY - at);
    if (valid && LIST_LANE == 0u) STORE16(ranges, k, uvec4(n > 0u ? at : 0u, room, 0u, 0u))
    if (ANY_IN_SUBGROUP(mine > kKept ? 1u : 0u))
      fill_pairs(min(k, TRIANGLES + VERTICES - 1u), share, at, room);
    else
      for (uint m = 0u; m < mine; ++m)
        if (kept[m].y < room) write_pair(at + kept[m].y, k, kept[m].x);
  }
}

void note_list(uint level) {
  uint all = ledger.counted[level];
  ledger.pairs = min(all, CAPACITY);
  ledger.reach = 1.0 / float(1u << CUT_BITS * level);
  if (all > CAPACITY) faults.dropped += all - CAPACITY;
}

/// The frame's list of pairs. With kLooksForFar there is none where a slow cloth meets no piece.
bool list_pairs() {
  bool may_be_far = kLooksForFar && is_slow();
  if (thread == 0u) any_near = kFar;
  for (uint word = thread; word < GROUP_WORDS; word += THREADS) near_groups[word] = 0u;
  empty_box();
  float carried = greatest_displacement();
  if (me == 0u) {
    ledger.carried = carried;
    ledger.reach = 1.0;
    ledger.pairs = ledger.touched_vertices = ledger.meets = 0u;
    for (uint l = 0u; l < PAIR_LEVELS; ++l) ledger.counted[l] = 0u;
  }
  MEET_OR_FAIL;  // empty boxes before they are widened
  reach_and_widen(carried);
  MEET_OR_FAIL;  // reaches before the list
  if (me == 0u) ledger.farthest = 0u;  // until here of the last frame
  for (uint g = thread; g < GROUPS; g += THREADS)
    if (meets_cloth(LOAD(32u, boxes, PIECES + g))) {
      uint bit = g / GROUPS_A_BIT;
      atomicOr(near_groups[bit / 32u], 1u << bit % 32u);
      any_near = kListed;
    }
  barrier();  // every thread's look before the answer
  if (PIECES == 0u || (any_near == kFar && may_be_far)) return true;
  uint level = 0u;
  for (;; ++level) {
    list_at(1.0 / float(1u << CUT_BITS * level), level);
    if (thread == 0u && any_near == kMeets) ledger.meets = 1u;
    MEET_OR_FAIL;  // pairs before they are read, and their number
    if (may_be_far && ledger.meets == 0u) return true;
    if (level + 1u == PAIR_LEVELS || ledger.counted[level] <= CAPACITY) break;
  }
  if (me == 0u) note_list(level);
  EACH(i, VERTICES) list_touched(i);
  MEET_OR_FAIL;  // the list before it is read
  return true;
}

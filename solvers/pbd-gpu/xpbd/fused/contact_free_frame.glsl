// Contact-free fast path (xpbd/fused/README.md). The bound on how far the cloth moves is an estimate, not a guarantee:
// check_motion_bound() tests it after every substep.
const uint kMaxNearbyGroups = 32u;  // with more groups of shapes, the frame has contact without further tests
shared uint nearby_groups[kMaxNearbyGroups], nearby_group_count, max_displacement;
vec3 box_low, box_high;
float rest, by_hands;

/// Position of vertex i at the frame's start; w: its motion bound in a contact-free frame [m].
vec4 contact_free_position(uint i) {
  vec4 at = x[i];
  return vec4(at.xyz, contact_free_bound(length(v[i].xyz), rest, by_hands));
}

bool overlaps_shapes(uint group, vec3 low, vec3 high) {
  ShapeAabb of = boxes[SHAPES + group];
  if (!(all(lessThanEqual(low, of.high.xyz)) && all(lessThanEqual(of.low.xyz, high)))) return false;
  uint first = SHAPES_PER_GROUP * group, end = min(first + SHAPES_PER_GROUP, SHAPES);
  for (uint q = first; q < end; ++q) {
    ShapeAabb b = boxes[q];
    if (all(lessThanEqual(low, b.high.xyz)) && all(lessThanEqual(b.low.xyz, high))) return true;
  }
  return false;
}

/// Whether the box of a cell, its four vertices inflated by their motion bounds, overlaps a shape of a nearby group.
bool cell_may_touch(uint cell) {
  uint i = cell / (COLUMNS - 1u) * COLUMNS + cell % (COLUMNS - 1u);
  vec3 low = vec3(1e30), high = vec3(-1e30);
  for (uint c = 0u; c < 4u; ++c) {
    vec4 at = contact_free_position(i + c % 2u + c / 2u * COLUMNS);
    low = min(low, at.xyz - at.w);
    high = max(high, at.xyz + at.w);
  }
  for (uint n = 0u; n < nearby_group_count && any_nearby == 0u; ++n)
    if (overlaps_shapes(nearby_groups[n], low, high)) return true;
  return false;
}

/// Whether the frame can be simulated without contact; the same in all threads. If the last frame had contact or the
/// cloth is fast, any group of convex shapes that overlaps the cloth's box counts as contact: testing each cell would
/// lengthen a frame on a desk by a tenth.
bool cannot_reach_any_collider() {
  bool tests_cells = frame_state.contact_possible == 0u && is_slow();
  if (thread == 0u) any_nearby = nearby_group_count = max_displacement = 0u;
  empty_box();
  barrier();  // wait for the empty box before threads grow it
  float max_shape_displacement = max_displacement_of_shapes();
  rest = bound_at_rest();
  by_hands = pulled();
  uvec3 from = uvec3(kLowNone), to = uvec3(kHighNone);
  for (uint i = thread; i < COLUMNS * ROWS; i += THREADS) {
    vec4 at = x[i];
    widen(from, to, vec4(at.xyz, motion_bound(length(v[i].xyz), rest, max_shape_displacement, by_hands)));
  }
  widen_box(from, to);
  barrier();  // wait for the cloth's box before threads test groups of shapes against it
  for (uint g = thread; g < GROUPS; g += THREADS) {
    if (!overlaps_cloth(boxes[SHAPES + g])) continue;
    uint n = atomicAdd(nearby_group_count, 1u);
    if (n < kMaxNearbyGroups) nearby_groups[n] = g;
    if (n >= kMaxNearbyGroups || !tests_cells) any_nearby = 1u;
  }
  box_low = vec3(of_ordered(cloth_low[0]), of_ordered(cloth_low[1]), of_ordered(cloth_low[2]));
  box_high = vec3(of_ordered(cloth_high[0]), of_ordered(cloth_high[1]), of_ordered(cloth_high[2]));
  barrier();  // wait for the nearby groups before threads test cells against them
  const uint cells = (COLUMNS - 1u) * (ROWS - 1u);
  for (uint cell = thread; nearby_group_count > 0u && cell < cells && any_nearby == 0u; cell += THREADS)
    if (cell_may_touch(cell)) any_nearby = 1u;
  barrier();  // wait for all tests before threads read any_nearby
  if (thread == 0u) frame_state.contact_free = 0u;
  return any_nearby == 0u;
}

/// After a substep: sets any_nearby if a vertex has left its motion bound, because it could then touch a shape.
void check_motion_bound() {
  [[unroll]] for (uint k = 0u; k < K; ++k) {
    uint i = lane * K + k;
    if (!on_chain(i)) continue;
    bool stays = all(greaterThanEqual(pos[k], box_low)) && all(lessThanEqual(pos[k], box_high));
    if (stays && nearby_group_count > 0u) {
      vec4 at = contact_free_position(index_of(vertex(i)));
      stays = distance(pos[k], at.xyz) <= at.w;
    }
    if (!stays) any_nearby = 1u;
  }
}

/// Stores the frame's largest displacement of a vertex, which the next frame and the host use.
void record_max_displacement() {
  [[unroll]] for (uint k = 0u; k < K; ++k) {
    uint i = lane * K + k;
    if (on_chain(i)) atomicMax(max_displacement, floatBitsToUint(distance(pos[k], x[index_of(vertex(i))].xyz)));
  }
  barrier();  // wait for all displacements before thread 0 reads the maximum
  if (thread == 0u) frame_state.max_displacement = max_displacement;
}

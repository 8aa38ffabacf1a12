// Active pairs of self-contact, after the constraint solve, one subgroup per triangle. The order of triangles among the
// active pairs is not fixed, and nothing depends on it; each triangle's pairs keep their order in the list.
#include "xpbd/contact/lanes_per_triangle.glsl"

/// Reserves entries for a triangle's `count` active pairs. Returns the first index, and how many pairs fit.
uvec2 reserve(uint count) {
  uint first = count > 0u ? atomicAdd(frame_state.self_active, count) : 0u;
  uint room = first < ACTIVE_CAPACITY ? ACTIVE_CAPACITY - first : 0u;
  if (count > room) atomicAdd(diagnostics.overflow, count - room);
  return uvec2(first, min(count, room));
}

// Each thread tests a few pairs at a time, so that the loads are issued together.
const uint kPairUnroll = 4u;
SelfPair pair[kPairUnroll];
bool is_active_pair[kPairUnroll];

/// Tests this lane's pairs from `first` on. `lessens`: reduces their bounds by the last substep's displacements first.
void test_pairs(uint first, uint end, vec4 own, bool lessens) {
  vec4 displacement[kPairUnroll];
  [[unroll]] for (uint n = 0u; n < kPairUnroll; ++n)
    pair[n] = self_pairs[min(first + n * lanes_per_triangle() + triangle_lane(), end - 1u)];
  [[unroll]] for (uint n = 0u; n < kPairUnroll; ++n) displacement[n] = triangle_max_displacement[pair[n].other];
  [[unroll]] for (uint n = 0u; n < kPairUnroll; ++n) {
    uint k = first + n * lanes_per_triangle() + triangle_lane();
    is_active_pair[n] = triangle_lane() < lanes_per_triangle() && k < end;
    if (lessens) pair[n].bound = pair[n].bound - own.x - displacement[n].x;
    if (is_active_pair[n] && lessens) self_pairs[k].bound = pair[n].bound;
    is_active_pair[n] = is_active_pair[n] && pair[n].bound <= own.y + displacement[n].y;
  }
}

void collect_active_pairs(uint t) {
  uvec4 range = self_ranges[t];
  vec4 own = triangle_max_displacement[t];
  uint count = 0u, end = range.x + range.y;
  for (uint first = range.x; first < end; first += kPairUnroll * lanes_per_triangle()) {
    test_pairs(first, end, own, true);
    [[unroll]] for (uint n = 0u; n < kPairUnroll; ++n) count += uint(bitCount(ballot_bits(is_active_pair[n])));
  }
  uvec2 slot = uvec2(0u);
  if (triangle_lane() == 0u) {
    slot = reserve(count);
    self_ranges[t] = uvec4(range.xy, slot);
  }
  uint at = from_first_lane(slot.x), last = at + from_first_lane(slot.y);
  for (uint first = range.x; first < end && at < last; first += kPairUnroll * lanes_per_triangle()) {
    test_pairs(first, end, own, false);
    [[unroll]] for (uint n = 0u; n < kPairUnroll; ++n) {
      uint bits = ballot_bits(is_active_pair[n]), before = at + uint(bitCount(bits & ((1u << triangle_lane()) - 1u)));
      if (is_active_pair[n] && before < last) {
        self_active[before].own = t;
        self_active[before].other = pair[n].other;
        self_active[before].link = first + n * lanes_per_triangle() + triangle_lane();
      }
      at += uint(bitCount(bits));
    }
  }
}

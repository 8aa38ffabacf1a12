#version 450
// After the lines, a thread a triangle; SHUFFLES: a subgroup a triangle.
#define SUBGROUPS
#include "common.glsl"
#include "plane_buffers.glsl"
// Pairs of a triangle that are near in this substep. Where a triangle's begin is in no fixed order, and nothing depends on it; those of
// one triangle are in the order of its list.
#include "self_share.glsl"

/// Where a triangle's near pairs begin, and how many there is place for.
uvec2 reserve(uint count) {
  uint first = count > 0u ? atomicAdd(ledger.self_near, count) : 0u;
  uint room = first < NEAR_CAPACITY ? NEAR_CAPACITY - first : 0u;
  if (count > room) atomicAdd(faults.dropped, count - room);
  return uvec2(first, min(count, room));
}

// Each thread looks at a few pairs at a time: their loads do not wait for one another.
const uint kAtOnce = 4u;
SelfPair pair[kAtOnce];
bool near[kAtOnce];

/// The pairs from `first` on that are this thread's, and whether they are near.
void look_at(uint first, uint end, vec4 own, bool lessens) {
  vec4 way[kAtOnce];
  [[unroll]] for (uint n = 0u; n < kAtOnce; ++n) pair[n] = self_pairs[min(first + n * sharers() + sharer(), end - 1u)];
  [[unroll]] for (uint n = 0u; n < kAtOnce; ++n) way[n] = LOAD16(self_ways, pair[n].other);
  [[unroll]] for (uint n = 0u; n < kAtOnce; ++n) {
    uint k = first + n * sharers() + sharer();
    near[n] = sharer() < sharers() && k < end;
    if (lessens) pair[n].bound = pair[n].bound - own.x - way[n].x;  // the ways of the last substep
    if (near[n] && lessens) self_pairs[k].bound = pair[n].bound;
    near[n] = near[n] && pair[n].bound <= own.y + way[n].y;
  }
}

void collect_near(uint t) {
  uvec4 range = LOAD16(self_ranges, t);
  vec4 own = LOAD16(self_ways, t);
  uint count = 0u, end = range.x + range.y;
  for (uint first = range.x; first < end; first += kAtOnce * sharers()) {
    look_at(first, end, own, true);
    [[unroll]] for (uint n = 0u; n < kAtOnce; ++n) count += near[n] ? 1u : 0u;
  }
  count = sum_of_sharers(uvec4(count, 0u, 0u, 0u)).x;
  uvec2 place = uvec2(0u);
  if (sharer() == 0u) {
    place = reserve(count);
    STORE16(self_ranges, t, uvec4(range.xy, place));
  }
  uint at = from_first(place.x), last = at + from_first(place.y);
  for (uint first = range.x; first < end && at < last; first += kAtOnce * sharers()) {
    look_at(first, end, own, false);
    [[unroll]] for (uint n = 0u; n < kAtOnce; ++n) {
      uint bits = votes(near[n]), before = at + uint(bitCount(bits & ((1u << sharer()) - 1u)));
      if (near[n] && before < last) {
        self_near[before].own = t;
        self_near[before].other = pair[n].other;
        self_near[before].link = first + n * sharers() + sharer();
      }
      at += uint(bitCount(bits));
    }
  }
}

void main() {
  EACH_SHARED(t, TRIANGLES, collect_near(t);)
}

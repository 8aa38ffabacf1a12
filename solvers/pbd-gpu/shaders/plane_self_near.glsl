// Pairs of a triangle that are near in this substep. Where a triangle's begin is in no fixed order, and nothing depends on it; those of
// one triangle are in the order of its list.
#include "self_share.glsl"

/// A pair's bound loses the ways of the last substep.
bool is_near_self(uint k, vec4 own) {
  vec4 other = LOAD16(self_ways, self_pairs[k].other);
  float bound = self_pairs[k].bound - own.x - other.x;
  self_pairs[k].bound = bound;
  return bound <= own.y + other.y;
}

/// Where a triangle's near pairs begin, and how many there is place for.
uvec2 reserve(uint count) {
  uint first = count > 0u ? atomicAdd(ledger.self_near, count) : 0u;
  uint room = first < NEAR_CAPACITY ? NEAR_CAPACITY - first : 0u;
  if (count > room) atomicAdd(faults.dropped, count - room);
  return uvec2(first, min(count, room));
}

void collect_near(uint t) {
  uvec4 range = LOAD16(self_ranges, t);
  vec4 own = LOAD16(self_ways, t);
  uint count = 0u, end = range.x + range.y;
  for (uint k = range.x; k < end; k += sharers())
    count += uint(bitCount(votes(sharer() < sharers() && k + sharer() < end && is_near_self(k + sharer(), own))));
  uvec2 place = uvec2(0u);
  if (sharer() == 0u) {
    place = reserve(count);
    STORE16(self_ranges, t, uvec4(range.xy, place));
  }
  uint at = from_first(place.x), last = at + from_first(place.y);
  for (uint begin = range.x; begin < end && at < last; begin += sharers()) {
    uint k = begin + sharer(), other = 0u;
    bool mine = false;
    if (sharer() < sharers() && k < end) {
      other = self_pairs[k].other;
      mine = self_pairs[k].bound <= own.y + LOAD16(self_ways, other).y;
    }
    uint bits = votes(mine), before = at + uint(bitCount(bits & ((1u << sharer()) - 1u)));
    if (mine && before < last) {
      self_near[before].own = t;
      self_near[before].other = other;
      self_near[before].link = k;
    }
    at += uint(bitCount(bits));
  }
}

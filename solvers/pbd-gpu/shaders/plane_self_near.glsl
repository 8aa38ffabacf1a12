// Pairs of a triangle that are near in this substep. Where a triangle's begin is in no fixed order, and nothing depends on it; those of
// one triangle are in the order of its list.

/// Before the lines a pair's bound loses the ways of the last substep.
bool is_near_self(uint k, vec4 own) {
  vec4 other = LOAD16(self_ways, self_pairs[k].other);
  float bound = self_pairs[k].bound;
  if (turn == 0u) {
    bound -= own.x + other.x;
    self_pairs[k].bound = bound;
  }
  return bound <= own.y + other.y;
}

void collect_near(uint t) {
  uvec4 range = LOAD16(self_ranges, t);
  vec4 own = LOAD16(self_ways, t);
  uint count = 0u;
  for (uint k = range.x; k < range.x + range.y; ++k)
    if (is_near_self(k, own)) ++count;
  uint first = count > 0u ? atomicAdd(ledger.self_near[min(turn, 1u)], count) : 0u;
  uint room = first < NEAR_CAPACITY ? NEAR_CAPACITY - first : 0u;
  if (count > room) {
    atomicAdd(faults.dropped, count - room);
    count = room;
  }
  STORE16(self_ranges, t, uvec4(range.xy, first, count));
  uint at = first;
  for (uint k = range.x; at < first + count; ++k) {
    uint other = self_pairs[k].other;
    if (!(self_pairs[k].bound <= own.y + LOAD16(self_ways, other).y)) continue;
    self_near[at].own = t;
    self_near[at].other = other;
    self_near[at].link = k;
    ++at;
  }
}

// Pairs that are near in this substep; the phases that follow take notice of those alone. Each has a bit, by which vertices find
// those of their triangles in the order of the list, and a place in a list of near pairs in no fixed order, by which threads share
// them out: each is asked for itself.

float piece_way(uint k) { return p.substep_part * LOAD16_OF(boxes[k].low).w; }
float most_of(uvec4 e, bool of_ways) {
  float most = 0.0;
  for (uint c = 0u; c < e.w; ++c) most = max(most, of_ways ? LOAD4(ways, e[c]) : starts[e[c]].w);
  return most;
}

/// Whether a pair is near enough to be asked in this substep, or has been. Before the lines its bound loses the ways of the last one.
bool is_near(uint k) {
  uvec4 pair = LOAD16(pairs, k);
  uvec4 e = LOAD16(elements, pair.x);
  float moved = piece_way(pair.y), bound = states[k].normal.w;
  if (turn == 0u) {
    bound -= most_of(e, true) + moved;
    states[k].normal.w = bound;
    if (pair.z != 0u) pairs[k].z = pair.z = 0u;
  }
  return bound <= most_of(e, false) + moved || pair.z != 0u;
}

void list_near(uint k) {
  atomicOr(near_bits[k / 32u], 1u << k % 32u);
  pairs[atomicAdd(NEAR_COUNT, 1u)].w = k;
}

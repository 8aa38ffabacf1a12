// Pairs that are near in this substep; the phases that follow take notice of those alone. Each has a bit, by which vertices find
// those of their triangles in the order of the list, and a place in a list of near pairs in no fixed order, by which threads share
// them out: each is asked for itself.

float piece_way(uint k) { return p.substep_part * LOAD16_OF(boxes[k].low).w; }
float most_of(uvec4 e, bool of_ways) {
  float most = 0.0;
  [[unroll]] for (uint c = 0u; c < 3u; ++c) {
    uint i = e[min(c, e.w - 1u)];
    most = max(most, of_ways ? LOAD4(ways, i) : starts[i].w);
  }
  return most;
}

/// Most by which a pair may approach in this substep.
float approach_of(uvec4 e, uint k) { return most_of(e, false) + piece_way(k); }

/// Whether the bound of a pair's distance lets it be near in this substep, or whether it has been. First the bound loses the ways of the
/// last one.
bool may_be_near(uint k) {
  uvec4 pair = LOAD16(pairs, k);
  uvec4 e = LOAD16(elements, pair.x);
  float bound = states[k].normal.w;
  if (turn == FIRST_TURN) {
    bound -= most_of(e, true) + piece_way(pair.y);
    states[k].normal.w = bound;
    if (pair.z != 0u) pairs[k].z = pair.z = 0u;
  }
  return bound <= approach_of(e, pair.y) || pair.z != 0u;
}

/// Whether it is: not if the gap along the last normal, or from middle to middle, is too wide. That is a bound like any other, and costs
/// less than nearest points.
bool is_near(uint k) {
  uvec4 pair = LOAD16(pairs, k);
  if (pair.z != 0u) return true;
  uvec4 e = LOAD16(elements, pair.x);
  piece = pieces[pair.y];
  around = starts[e.x].xyz;
  [[unroll]] for (uint c = 0u; c < 3u; ++c) cloth[c] = starts[e[min(c, e.w - 1u)]].xyz - around;
  vec3 n = states[k].normal.xyz;
  if (n == vec3(0.0)) {
    PieceBox box = LOAD(32u, boxes, pair.y);
    n = (cloth[0] + cloth[1] + cloth[2]) / 3.0 - (0.5 * (box.low.xyz + box.high.xyz) - around);
  }
  float l = length(n);
  if (!(l > 0.0)) return true;
  n /= l;
  float gap = gap_now(n, t_begin) - piece.radius;
  if (!(gap > approach_of(e, pair.y))) return true;
  states[k].normal = vec4(n, gap);
  return false;
}

void list_near(uint k, uint place) {
  atomicOr(near_bits[NEAR_BITS + k / 32u], 1u << k % 32u);
  pairs[place].w = k;
}

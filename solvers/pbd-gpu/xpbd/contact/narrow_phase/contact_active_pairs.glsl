// Selects the active pairs of a substep: the candidate pairs that can come into contact before its end. An active pair
// is recorded twice: as a bit in active_bits, so that a vertex visits its pairs in the fixed order of the candidate
// list (sums stay reproducible), and as an entry of a list in any order, over which threads are distributed.

float shape_displacement(uint k) { return p.substep_part * boxes[k].low.w; }
float max_of(uvec4 e, bool of_ways) {
  float largest = 0.0;
  [[unroll]] for (uint c = 0u; c < 3u; ++c) {
    uint i = e[min(c, e.w - 1u)];
    largest = max(largest, of_ways ? vertex_displacement[i] : starts[i].w);
  }
  return largest;
}

/// Maximum approach of a pair in this substep, plus the contact offset [m].
float approach_of(uvec4 e, uint k) {
  return max_of(e, false) + shape_displacement(k) + (SELF != 0u ? MARGIN_M : 0.0);
}

/// Whether the lower bound of a pair's distance allows contact in this substep, or round 0 has processed the pair. In
/// the substep's first round, the bound is reduced by the last substep's displacements.
bool may_be_active(uint k) {
  uvec4 pair = pairs[k];
  uvec4 e = primitives[pair.x];
  float bound = states[k].normal.w;
  if (response_round == FIRST_ROUND) {
    bound -= max_of(e, true) + shape_displacement(pair.y);
    states[k].normal.w = bound;
    if (pair.z != 0u) pairs[k].z = pair.z = 0u;
  }
  return bound <= approach_of(e, pair.y) || pair.z != 0u;
}

/// Whether the gap along the last normal (without one: along the centres' line) allows contact; cheaper than GJK.
bool is_active(uint k) {
  uvec4 pair = pairs[k];
  if (pair.z != 0u) return true;
  uvec4 e = primitives[pair.x];
  shape = shapes[pair.y];
  around = starts[e.x].xyz;
  [[unroll]] for (uint c = 0u; c < 3u; ++c) cloth[c] = starts[e[min(c, e.w - 1u)]].xyz - around;
  vec3 n = states[k].normal.xyz;
  if (n == vec3(0.0)) {
    ShapeAabb box = boxes[pair.y];
    n = (cloth[0] + cloth[1] + cloth[2]) / 3.0 - (0.5 * (box.low.xyz + box.high.xyz) - around);
  }
  float l = length(n);
  if (!(l > 0.0)) return true;
  n /= l;
  float gap = gap_now(n, t_begin) - shape.radius;
  if (!(gap > approach_of(e, pair.y))) return true;
  states[k].normal = vec4(n, gap);
  return false;
}

void append_active(uint k, uint slot) {
  atomicOr(active_bits[ACTIVE_BITS + k / 32u], 1u << k % 32u);
  pairs[slot].w = k;
}

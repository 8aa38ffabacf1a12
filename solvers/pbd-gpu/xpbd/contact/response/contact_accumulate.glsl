// Accumulates corrections (Jacobi averaging): each vertex moves by the mean of its contacts' proposals, weighted by
// length. In round 0 `velocity_part` changes only v, because the prediction that follows moves x by h v; and the
// inverse mass of a corrected vertex is reduced. The order of summation is the same for any number of lanes: each of
// kPartialSums sums takes every kPartialSums-th triangle, and the last one also the vertex's own pairs.
const uint kPartialSums = 8u;
bool any_pairs = true;  // whether contacts with convex shapes correct the vertex in this round
vec3 sum, sum_velocity_part;
float lengths;

void propose(vec3 velocity_part, vec3 depenetration) {
  vec3 all = velocity_part + depenetration;
  float l = length(all);
  sum += l * all;
  sum_velocity_part += l * velocity_part;
  lengths += l;
}

void from_half_spaces(vec4 at, vec3 start) {
  if (response_round == 0u) return;
  for (uint k = 0u; k < PLANES; ++k) {
    PlaneShape s = half_spaces[k];
    float before = dot(start, s.normal.xyz) - s.normal.w, gap = dot(at.xyz, s.normal.xyz) - s.normal.w;
    Correction c = respond_along(s.normal.xyz, min(s.margin, before) - gap, recovery(s.margin - before, s.margin),
                                 at.xyz - start, s.friction);
    if (c.velocity_part != vec3(0.0) || c.depenetration > 0.0) propose(c.velocity_part, c.depenetration * s.normal.xyz);
  }
}

void from_pairs(uint primitive, uint corner, float w) {
  FOR_EACH_PAIR_OF(CORRECTION_BITS, ranges[primitive], {
    vec4 correction = states[k].correction;
    float share = w * states[k].weights[corner];
    propose(share * correction.xyz, share * correction.w * states[k].normal.xyz);
  })
}

// Pairs of a triangle are read a few at a time, so that the loads are issued together.
const uint kSelfPairUnroll = 4u, kNoCorrection = ~0u;
/// Adds the corrections that self-contact pairs of triangle `primitive` propose for its vertex `corner`.
void from_self(uint primitive, uint corner) {
  uvec4 range = self_ranges[primitive];
  for (uint first = range.z, end = range.z + range.w; first < end; first += kSelfPairUnroll) {
    uint at[kSelfPairUnroll];
    vec4 all[kSelfPairUnroll], velocity_part[kSelfPairUnroll];
    [[unroll]] for (uint n = 0u; n < kSelfPairUnroll; ++n) {
      uint k = min(first + n, end - 1u);
      bool has = first + n < end && (self_active[k].marks & ~SELF_PLANE) != 0u;
      at[n] = has ? 3u * self_active[k].link + corner : kNoCorrection;
    }
    [[unroll]] for (uint n = 0u; n < kSelfPairUnroll; ++n) {
      uint from = at[n] == kNoCorrection ? 0u : at[n];
      all[n] = self_corrections[from].all;
      velocity_part[n] = self_corrections[from].velocity_part;
    }
    [[unroll]] for (uint n = 0u; n < kSelfPairUnroll; ++n) {
      if (at[n] == kNoCorrection || all[n].w == 0.0) continue;
      sum += all[n].xyz;
      sum_velocity_part += velocity_part[n].xyz;
      lengths += all[n].w;
    }
  }
}

void accumulate_part(uint i, vec4 at, uint part) {
  if (part + 1u == kPartialSums) {
    from_half_spaces(at, starts[i].xyz);
    if (any_pairs) from_pairs(TRIANGLES + i, 0u, at.w);
  }
  uint first = vertex_triangles[i] + part, end = vertex_triangles[i + 1u];
  for (uint k = first; k < end; k += kPartialSums) {
    uint vertex_triangle = vertex_triangles[k];
    if (any_pairs) from_pairs(vertex_triangle / 4u, vertex_triangle % 4u, at.w);
    if (SELF != 0u && response_round > 0u) from_self(vertex_triangle / 4u, vertex_triangle % 4u);
  }
}

/// Adds all partial sums in a fixed order; every lane of the cluster gets the total.
void accumulate_parts(uint i, vec4 at, bool live) {
  vec3 of_all = vec3(0.0), velocity_part_of_all = vec3(0.0);
  float lengths_of_all = 0.0;
  [[unroll]] for (uint k = 0u; k < kPartialSums; k += LANES_PER_VERTEX) {
    sum = sum_velocity_part = vec3(0.0);
    lengths = 0.0;
    if (live) accumulate_part(i, at, k + cluster_lane());
    [[unroll]] for (uint n = 0u; n < LANES_PER_VERTEX; ++n) {
      of_all += FROM_LANE(sum, n);
      velocity_part_of_all += FROM_LANE(sum_velocity_part, n);
      lengths_of_all += FROM_LANE(lengths, n);
    }
  }
  sum = of_all;
  sum_velocity_part = velocity_part_of_all;
  lengths = lengths_of_all;
}

void accumulate(uint i, bool valid) {
  vec4 at = valid ? y[i] : vec4(0.0);
  any_pairs = valid && SHAPES > 0u && touched[CORRECTED(i)] != 0u;
  accumulate_parts(i, at, at.w != 0.0 && (any_pairs || PLANES > 0u || SELF != 0u));
  if (cluster_lane() != 0u) return;
  if (any_pairs) touched[CORRECTED(i)] = 0u;
  if (!(lengths > 0.0)) return;
  vec3 by = sum / lengths, velocity_part = sum_velocity_part / lengths;
  v[i] = vec4(v[i].xyz + p.per_h * velocity_part, 0.0);
  if (response_round > 0u) {
    y[i] = vec4(at.xyz + by, at.w);
    if (SECOND_SOLVE && response_round == 1u) x[i] = vec4(at.xyz + by, at.w);
    return;
  }
  float held = dot(by, by) / (kImpactMassFactor * MARGIN_M * kImpactMassFactor * MARGIN_M);
  x[i] = vec4(x[i].xyz + by - velocity_part, at.w / (1.0 + held));
}

/// Thread `first` of `at_once` threads and its cluster process their part of the vertices that contact may move.
void accumulate_all(uint first, uint at_once) {
  bool all_of_them = PLANES > 0u || SELF != 0u;
  uint count = all_of_them ? VERTICES : frame_state.touched_vertices;
  for (uint n = first / LANES_PER_VERTEX; subgroupAny(n < count); n += at_once / LANES_PER_VERTEX) {
    bool valid = n < count;
    uint i = n;
    if (valid && !all_of_them) i = touched[n];
    accumulate(i, valid);
  }
}

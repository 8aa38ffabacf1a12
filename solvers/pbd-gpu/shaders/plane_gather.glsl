// A round's end: a vertex takes the mean of what its contacts propose, weighted by length (Jacobi: no contact sees another's move).
// Before the lines the proposed corrections go into velocity and position, and what moving pieces pushed is heavier in the lines.
// The sum has a fixed order, whatever the number of lanes that share it: SHARES of it, of a vertex' own pairs and of every SHARES-th
// triangle, one after another.
const uint SHARES = 8u;
bool any_pairs = true;  // that push the vertex
vec3 sum, sum_moving;
float lengths;

void propose(vec3 moving, vec3 out_by) {
  vec3 all = moving + out_by;
  float l = length(all);
  sum += l * all;
  sum_moving += l * moving;
  lengths += l;
}

void from_half_spaces(vec4 at, vec3 start) {
  if (turn == 0u) return;
  for (uint k = 0u; k < PLANES; ++k) {
    PlaneShape s = LOAD(32u, half_spaces, k);
    float before = dot(start, s.normal.xyz) - s.normal.w, gap = dot(at.xyz, s.normal.xyz) - s.normal.w;
    Correction c = respond_along(s.normal.xyz, min(s.margin, before) - gap, recovery(s.margin - before, s.margin), at.xyz - start, s.friction);
    if (c.moving != vec3(0.0) || c.out_by > 0.0) propose(c.moving, c.out_by * s.normal.xyz);
  }
}

void from_pairs(uint element, uint corner, float w) {
  EACH_PAIR_OF(PUSH_BITS, LOAD16(ranges, element), {
    vec4 push = LOAD16_OF(states[k].push);
    float share = w * states[k].weights[corner];
    propose(share * push.xyz, share * push.w * states[k].normal.xyz);
  })
}

// Pairs of a triangle are looked at a few at a time: their loads do not wait for one another.
const uint kSelfAtOnce = 4u, kNoPush = ~0u;
/// From the pairs of the vertex' triangles with others of the cloth.
void from_self(uint element, uint corner) {
  uvec4 range = LOAD16(self_ranges, element);
  for (uint first = range.z, end = range.z + range.w; first < end; first += kSelfAtOnce) {
    uint at[kSelfAtOnce];
    vec4 all[kSelfAtOnce], moving[kSelfAtOnce];
    [[unroll]] for (uint n = 0u; n < kSelfAtOnce; ++n) {
      uint k = min(first + n, end - 1u);
      bool has = first + n < end && (self_near[k].marks & ~SELF_PLANE) != 0u;
      at[n] = has ? 3u * self_near[k].link + corner : kNoPush;
    }
    [[unroll]] for (uint n = 0u; n < kSelfAtOnce; ++n) {
      uint from = at[n] == kNoPush ? 0u : at[n];
      all[n] = LOAD16_OF(self_pushes[from].all);
      moving[n] = LOAD16_OF(self_pushes[from].moving);
    }
    [[unroll]] for (uint n = 0u; n < kSelfAtOnce; ++n) {
      if (at[n] == kNoPush || all[n].w == 0.0) continue;
      sum += all[n].xyz;
      sum_moving += moving[n].xyz;
      lengths += all[n].w;
    }
  }
}

void gather_part(uint i, vec4 at, uint part) {
  if (part + 1u == SHARES) {
    from_half_spaces(at, LOAD16(starts, i).xyz);
    if (any_pairs) from_pairs(TRIANGLES + i, 0u, at.w);
  }
  uint first = LOAD4(fans, i) + part, end = LOAD4(fans, i + 1u);
  for (uint k = first; k < end; k += SHARES) {
    uint fan = LOAD4(fans, k);
    if (any_pairs) from_pairs(fan / 4u, fan % 4u, at.w);
    if (SELF != 0u && turn > 0u) from_self(fan / 4u, fan % 4u);
  }
}

/// The sums of all parts in their order, in every lane of the team.
void gather_parts(uint i, vec4 at, bool live) {
  vec3 of_all = vec3(0.0), moving_of_all = vec3(0.0);
  float lengths_of_all = 0.0;
  [[unroll]] for (uint k = 0u; k < SHARES; k += TEAM) {
    sum = sum_moving = vec3(0.0);
    lengths = 0.0;
    if (live) gather_part(i, at, k + team_lane());
    [[unroll]] for (uint n = 0u; n < TEAM; ++n) {
      of_all += FROM_LANE(sum, n);
      moving_of_all += FROM_LANE(sum_moving, n);
      lengths_of_all += FROM_LANE(lengths, n);
    }
  }
  sum = of_all;
  sum_moving = moving_of_all;
  lengths = lengths_of_all;
}

void gather(uint i, bool valid) {
  vec4 at = valid ? LOAD16(y, i) : vec4(0.0);
  any_pairs = valid && PIECES > 0u && LOAD4(touched, PUSHED(i)) != 0u;
  gather_parts(i, at, at.w != 0.0 && (any_pairs || PLANES > 0u || SELF != 0u));
  if (team_lane() != 0u) return;
  if (any_pairs) STORE4(touched, PUSHED(i), 0u);
  if (!(lengths > 0.0)) return;
  vec3 by = sum / lengths, moving = sum_moving / lengths;
  STORE16(v, i, vec4(LOAD16(v, i).xyz + p.per_h * moving, 0.0));
  if (turn > 0u) {
    STORE16(y, i, vec4(at.xyz + by, at.w));
    if (AGAIN && turn == 1u) STORE16(x, i, vec4(at.xyz + by, at.w));
    return;
  }
  float held = dot(by, by) / (kHold * MARGIN_M * kHold * MARGIN_M);
  STORE16(x, i, vec4(LOAD16(x, i).xyz + by - moving, at.w / (1.0 + held)));
}

/// Thread `first` of `at_once`, and the team that it is in, take their share of the vertices that contact may move.
void gather_all(uint first, uint at_once) {
  bool all_of_them = PLANES > 0u || SELF != 0u;
  uint count = all_of_them ? VERTICES : ledger.touched_vertices;
  for (uint n = first / TEAM; most_of_subgroup(n < count ? 1u : 0u) != 0u; n += at_once / TEAM) {
    bool valid = n < count;
    uint i = n;
    if (valid && !all_of_them) i = LOAD4(touched, n);
    gather(i, valid);
  }
}

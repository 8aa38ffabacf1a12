// A substep's end: a vertex' place before the planes of all its triangles that is nearest to the proposed one (Hildreth
// 1957: multipliers one after another), no farther than it may go. If that is not found, as near to it as planes let it come from a
// place that is known to be free.
const uint kSweeps = 30u;
const float kNoPlace_m = 2e-6;  // that a vertex may lack before its planes, by rounding
uint first_fan, end_fan, fan_step = 1u;
vec3 start;

/// Offset of a half-space of the scene in this substep; what starts behind it goes no deeper.
float half_space(PlaneShape s) {
  return s.normal.w + min(dot(start, s.normal.xyz) - s.normal.w, kGuard_m);
}

// Every plane of the vertex: `n`, `s` and `k`, its pair.
#define EACH_PLANE(BODY)                                                     \
  for (uint f = first_fan; f < end_fan; f += fan_step) {       \
    uint fan = fans[f], corner = fan % 4u;                                   \
    EACH_PAIR_OF(NEAR_BITS, ranges[fan / 4u],                                \
      if ((pairs[k].z & PAIR_PLANE) == 0u) continue;                         \
      vec4 plane = states[k].way;                                            \
      vec3 n = plane.xyz;                                                    \
      float s = plane.w;                                                     \
      BODY                                                                   \
    )                                                                        \
  }

// The same of the planes between its triangles and others of the cloth; `k`: the near pair. They are looked at a few at a time: their
// loads do not wait for one another.
const uint kSelfPlanesAtOnce = 4u;
#define EACH_SELF_PLANE(BODY)                                                \
  for (uint f = first_fan; SELF != 0u && f < end_fan; f += fan_step) {       \
    uint fan = fans[f], corner = fan % 4u;                                   \
    uvec2 range = self_ranges[fan / 4u].zw;                                  \
    for (uint begin = range.x, end = begin + range.y; begin < end; begin += kSelfPlanesAtOnce) { \
      vec4 planes[kSelfPlanesAtOnce];                                        \
      bool parts[kSelfPlanesAtOnce];                                         \
      [[unroll]] for (uint m = 0u; m < kSelfPlanesAtOnce; ++m) {             \
        uint of = min(begin + m, end - 1u);                                  \
        planes[m] = self_near[of].plane;                                     \
        parts[m] = (self_near[of].marks & SELF_PLANE) != 0u && begin + m < end; \
      }                                                                      \
      [[unroll]] for (uint m = 0u; m < kSelfPlanesAtOnce; ++m) {             \
        if (!parts[m]) continue;                                             \
        uint k = begin + m;                                                  \
        vec3 n = planes[m].xyz;                                              \
        float s = planes[m].w;                                               \
        BODY                                                                 \
      }                                                                      \
    }                                                                        \
  }

/// The least distance before any plane.
float worst(vec3 at) {
  float least = 1e30;
  for (uint h = 0u; h < PLANES; ++h) least = min(least, dot(at, half_spaces[h].normal.xyz) - half_space(half_spaces[h]));
  EACH_PLANE(least = min(least, dot(n, at) - s);)
  EACH_SELF_PLANE(least = min(least, dot(n, at) - s);)
  return least;
}

vec3 projected(vec3 at) {
  float of_half_spaces[PLANES + 1u];
  for (uint h = 0u; h < PLANES; ++h) of_half_spaces[h] = 0.0;
  for (uint sweep = 0u; sweep < kSweeps; ++sweep) {
    float most = 0.0;
    for (uint h = 0u; h < PLANES; ++h) {
      vec3 n = half_spaces[h].normal.xyz;
      float by = max(-of_half_spaces[h], half_space(half_spaces[h]) + kRounding_m - dot(n, at));
      of_half_spaces[h] += by;
      at += by * n;
      most = max(most, abs(by));
    }
    EACH_PLANE(
      float old = states[k].push[corner];
      float by = max(-old, s + kRounding_m - dot(n, at));
      if (by != 0.0) {
        states[k].push[corner] = old + by;
        at += by * n;
        most = max(most, abs(by));
      }
    )
    EACH_SELF_PLANE(
      float old = self_near[k].multipliers[corner];
      float by = max(-old, s + kRounding_m - dot(n, at));
      if (by != 0.0) {
        self_near[k].multipliers[corner] = old + by;
        at += by * n;
        most = max(most, abs(by));
      }
    )
    if (most < 0.5 * kRounding_m) break;
  }
  return at;
}

/// Displacement of a piece in this substep, its points' mean: what it carries along stays free of it.
vec3 way_of(uint k) {
  ContactPiece q = pieces[k];
  vec3 way = vec3(0.0);
  for (uint j = 0u; j < q.count; ++j) {
    PiecePoint at = points[q.first + j];
    way += at.end.xyz - at.start.xyz;
  }
  return way * p.substep_part / float(q.count);
}

/// From a free place as far towards `to` as planes and `room` let it.
vec3 back_from(vec3 to, float room) {
  vec3 free = start;
  float best = worst(start);
  EACH_PLANE(
    if (best < -kRounding_m && pieces[pairs[k].y].moves != 0u && s == s) {
      vec3 there = start + way_of(pairs[k].y);
      float is = worst(there);
      if (is > best) {
        best = is;
        free = there;
      }
    }
  )
  if (best < -kRounding_m) {
    float at_end = worst(to);
    if (at_end > best && distance(to, start) <= room) {
      best = at_end;
      free = to;
    }
    if (best < -kNoPlace_m) atomicAdd(faults.without_place, 1u);
    return free;
  }
  atomicAdd(faults.returned, 1u);
  float part = 1.0;
  for (uint h = 0u; h < PLANES; ++h) {
    float s = half_space(half_spaces[h]), from = dot(half_spaces[h].normal.xyz, free) - s, end = dot(half_spaces[h].normal.xyz, to) - s;
    if (end < 0.0) part = min(part, from > 0.0 ? from / (from - end) : 0.0);
  }
  EACH_PLANE(
    float from = dot(n, free) - s;
    float end = dot(n, to) - s;
    if (end < 0.0) part = min(part, from > 0.0 ? from / (from - end) : 0.0);
  )
  EACH_SELF_PLANE(
    float from = dot(n, free) - s;
    float end = dot(n, to) - s;
    if (end < 0.0) part = min(part, from > 0.0 ? from / (from - end) : 0.0);
  )
  vec3 way = part * (to - free);
  float left = max(0.0, room - distance(free, start)), l = length(way);
  return free + (l > left ? left / l : 1.0) * way;
}

/// As near to `at` as planes let a vertex come.
vec3 placed(vec3 at, float room) {
  at = projected(at);
  if (worst(at) >= -kRounding_m && distance(at, start) <= room) return at;
  return back_from(at, room);
}

vec3 within(vec3 to, float room) {
  vec3 way = to - start;
  float l = length(way);
  return l > room ? start + (room / l) * way : to;
}

#include "plane_way.glsl"

void end_substep(uint i, vec4 proposed, vec3 at) {
  if (proposed.w > 0.0) {
    if (at != proposed.xyz) STORE16(v, i, vec4(LOAD16(v, i).xyz + p.per_h * (at - proposed.xyz), 0.0));
    if (substep_now + 1u == p.substeps) note_way(i, at);
    STORE16(x, i, vec4(at, proposed.w));
  }
  STORE4(ways, i, distance(at, start));
  STORE16(starts, i, vec4(at, 0.0));
#ifdef PLANE_FRAME
  if (kPredictsEarly && substep_now + 1u < p.substeps) predict(i);
#endif
}

/// Of a vertex without planes.
void project_free(uint i) {
  vec4 proposed = LOAD16(y, i), from = LOAD16(starts, i);
  start = from.xyz;
  end_substep(i, proposed, proposed.w > 0.0 ? within(proposed.xyz, from.w) : proposed.xyz);
}

/// Every lane of a team comes along; one of them goes on where planes are in the way.
void project(uint i, bool valid) {
  vec4 proposed = vec4(0.0), from = vec4(0.0);
  float least = 1e30;
  if (valid) {
    proposed = LOAD16(y, i);
    from = LOAD16(starts, i);
  }
  start = from.xyz;
  vec3 at = proposed.xyz;
  if (proposed.w > 0.0) {
    at = within(at, from.w);
  }
  bool behind = PLANES > 0u || SELF != 0u || (PIECES > 0u && valid && LOAD4(touched, BEFORE_A_PLANE(i)) != 0u);
  if (proposed.w > 0.0 && (behind || at != proposed.xyz)) {
    uint first = LOAD4(fans, i);
    end_fan = LOAD4(fans, i + 1u);
    first_fan = first + team_lane();
    fan_step = TEAM;
    least = worst(at);
    first_fan = first;
    fan_step = 1u;
  }
  least = least_of_team(least);
  if (!valid || team_lane() != 0u) return;
  if (behind && PIECES > 0u) STORE4(touched, BEFORE_A_PLANE(i), 0u);
  if (proposed.w > 0.0 && !(least >= 0.0)) at = placed(at, from.w);
  end_substep(i, proposed, at);
}

/// Thread `first` of `at_once`, and the team that it is in, take their share of the vertices.
void project_all(uint first, uint at_once) {
  bool all_of_them = PLANES > 0u || SELF != 0u;
  for (uint i = first; !all_of_them && i < VERTICES; i += at_once)
    if (PIECES == 0u || LOAD4(touched, OF_PAIRS(i)) == 0u) project_free(i);
  uint count = all_of_them ? VERTICES : PIECES == 0u ? 0u : ledger.touched_vertices;
  for (uint n = first / TEAM; most_of_subgroup(n < count ? 1u : 0u) != 0u; n += at_once / TEAM) {
    bool valid = n < count;
    uint i = n;
    if (valid && !all_of_them) i = LOAD4(touched, n);
    project(i, valid);
  }
}

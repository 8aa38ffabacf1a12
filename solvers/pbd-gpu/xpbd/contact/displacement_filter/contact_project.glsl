// Last pass of a substep. Projects each vertex onto the half-spaces of its separating planes by Hildreth's (1957) dual
// coordinate descent. If that finds no feasible point, the vertex moves from a known one (its start, or its start
// carried along by a kinematic shape) towards the result until it reaches the first plane. If even the start violates
// a plane, the point with the smallest violation is used and counted in diagnostics.infeasible_vertices.
const uint kSweeps = 30u;
const float kFeasibilityTolerance = 10.0;  // [rounding errors] a smaller violation is rounding and not counted
uint first_vertex_triangle, end_vertex_triangle, vertex_triangle_step = 1u;
vec3 start;

/// Offset of a `plane` collider for this vertex: MIN_SEPARATION_M above the plane or, if lower, the vertex's start.
float half_space(PlaneShape s) {
  return s.normal.w + min(dot(start, s.normal.xyz) - s.normal.w, MIN_SEPARATION_M);
}

// Runs BODY for each plane of the vertex with a convex shape: normal `n`, offset `s`, pair `k`.
#define FOR_EACH_PLANE(BODY) \
  for (uint f = first_vertex_triangle; f < end_vertex_triangle; f += vertex_triangle_step) { \
    uint vertex_triangle = vertex_triangles[f], corner = vertex_triangle % 4u; \
    FOR_EACH_PAIR_OF(ACTIVE_BITS, ranges[vertex_triangle / 4u], \
      if ((pairs[k].z & PAIR_PLANE) == 0u) continue; \
      vec4 plane = states[k].displacement_or_plane; \
      vec3 n = plane.xyz; \
      float s = plane.w; \
      BODY \
    ) \
  }

// Like FOR_EACH_PLANE, for self-contact; `k`: the active pair. Loads of a few planes are issued together.
const uint kSelfPlaneUnroll = 4u;
#define FOR_EACH_SELF_PLANE(BODY) \
  for (uint f = first_vertex_triangle; SELF != 0u && f < end_vertex_triangle; f += vertex_triangle_step) { \
    uint vertex_triangle = vertex_triangles[f], corner = vertex_triangle % 4u; \
    uvec2 range = self_ranges[vertex_triangle / 4u].zw; \
    for (uint begin = range.x, end = begin + range.y; begin < end; begin += kSelfPlaneUnroll) { \
      vec4 planes[kSelfPlaneUnroll]; \
      bool has_plane[kSelfPlaneUnroll]; \
      [[unroll]] for (uint m = 0u; m < kSelfPlaneUnroll; ++m) { \
        uint of = min(begin + m, end - 1u); \
        planes[m] = self_active[of].plane; \
        has_plane[m] = (self_active[of].marks & SELF_PLANE) != 0u && begin + m < end; \
      } \
      [[unroll]] for (uint m = 0u; m < kSelfPlaneUnroll; ++m) { \
        if (!has_plane[m]) continue; \
        uint k = begin + m; \
        vec3 n = planes[m].xyz; \
        float s = planes[m].w; \
        BODY \
      } \
    } \
  }

#define FOR_EACH_PLANE_OF_ANY(BODY) FOR_EACH_PLANE(BODY) FOR_EACH_SELF_PLANE(BODY)

/// Minimum signed distance of `at` to the vertex's planes [m]; below 0: `at` is behind a plane.
float min_plane_distance(vec3 at) {
  float smallest = 1e30;
  for (uint h = 0u; h < PLANES; ++h)
    smallest = min(smallest, dot(at, half_spaces[h].normal.xyz) - half_space(half_spaces[h]));
  FOR_EACH_PLANE_OF_ANY(smallest = min(smallest, dot(n, at) - s);)
  return smallest;
}

vec3 project_on_planes(vec3 at) {
  float of_half_spaces[PLANES + 1u];
  for (uint h = 0u; h < PLANES; ++h) of_half_spaces[h] = 0.0;
  for (uint sweep = 0u; sweep < kSweeps; ++sweep) {
    float largest = 0.0;
    for (uint h = 0u; h < PLANES; ++h) {
      vec3 n = half_spaces[h].normal.xyz;
      float by = max(-of_half_spaces[h], half_space(half_spaces[h]) + ROUNDING_M - dot(n, at));
      of_half_spaces[h] += by;
      at += by * n;
      largest = max(largest, abs(by));
    }
    FOR_EACH_PLANE(
      float old = states[k].correction[corner];
      float by = max(-old, s + ROUNDING_M - dot(n, at));
      if (by != 0.0) {
        states[k].correction[corner] = old + by;
        at += by * n;
        largest = max(largest, abs(by));
      }
    )
    FOR_EACH_SELF_PLANE(
      float old = self_active[k].multipliers[corner];
      float by = max(-old, s + ROUNDING_M - dot(n, at));
      if (by != 0.0) {
        self_active[k].multipliers[corner] = old + by;
        at += by * n;
        largest = max(largest, abs(by));
      }
    )
    if (largest < 0.5 * ROUNDING_M) break;
  }
  return at;
}

/// Mean displacement of a convex shape's points in this substep: a vertex that the shape carries along stays outside.
vec3 shape_mean_displacement(uint k) {
  ConvexShape q = shapes[k];
  vec3 displacement = vec3(0.0);
  for (uint j = 0u; j < q.count; ++j) {
    ShapePoint at = points[q.first + j];
    displacement += at.end.xyz - at.start.xyz;
  }
  return displacement * p.substep_part / float(q.count);
}

/// Moves from a feasible position (start, or start carried along) towards `to`, up to a plane or `room` [m] from start.
vec3 back_from(vec3 to, float room) {
  vec3 free = start;
  float best = min_plane_distance(start);
  FOR_EACH_PLANE(
    if (best < -ROUNDING_M && shapes[pairs[k].y].is_kinematic != 0u && s == s) {
      vec3 there = start + shape_mean_displacement(pairs[k].y);
      float is = min_plane_distance(there);
      if (is > best) {
        best = is;
        free = there;
      }
    }
  )
  if (best < -ROUNDING_M) {
    float at_end = min_plane_distance(to);
    if (at_end > best && distance(to, start) <= room) {
      best = at_end;
      free = to;
    }
    if (best < -kFeasibilityTolerance * ROUNDING_M) atomicAdd(diagnostics.infeasible_vertices, 1u);
    return free;
  }
  float part = 1.0;
  for (uint h = 0u; h < PLANES; ++h) {
    float s = half_space(half_spaces[h]);
    float from = dot(half_spaces[h].normal.xyz, free) - s, end = dot(half_spaces[h].normal.xyz, to) - s;
    if (end < 0.0) part = min(part, from > 0.0 ? from / (from - end) : 0.0);
  }
  FOR_EACH_PLANE_OF_ANY(
    float from = dot(n, free) - s;
    float end = dot(n, to) - s;
    if (end < 0.0) part = min(part, from > 0.0 ? from / (from - end) : 0.0);
  )
  vec3 displacement = part * (to - free);
  float left = max(0.0, room - distance(free, start)), l = length(displacement);
  return free + (l > left ? left / l : 1.0) * displacement;
}

/// `to`, moved to at most `room` [m] from the start and to where the list of self-contact pairs is valid.
vec3 within(uint i, vec3 to, float room) {
  vec3 displacement = to - start;
  float l = length(displacement);
  if (l > room) to = start + (room / l) * displacement;
  if (SELF == 0u || frame_state.self_list_one_substep != 0u) return to;
  return clamp(to, self_bounds[i].low.xyz - ROOM_BESIDE_LAYERS, self_bounds[i].high.xyz + ROOM_BESIDE_LAYERS);
}

/// The feasible position nearest to `at` and within its limits; from back_from() if none is found.
vec3 project_to_feasible(uint i, vec3 at, float room) {
  at = project_on_planes(at);
  vec3 allowed = within(i, at, room);
  if (min_plane_distance(at) >= -ROUNDING_M && allowed == at) return at;
  return back_from(allowed, room);
}

#include "xpbd/contact/displacement_filter/max_displacement.glsl"

void end_substep(uint i, vec4 proposed, vec3 at) {
  if (proposed.w > 0.0) {
    if (at != proposed.xyz) v[i] = vec4(v[i].xyz + p.per_h * (at - proposed.xyz), 0.0);
    if (substep_now + 1u == p.substeps) record_displacement(i, at);
    x[i] = vec4(at, proposed.w);
  }
  vertex_displacement[i] = distance(at, start);
  starts[i] = vec4(at, 0.0);
#ifdef FUSED_FRAME
  if (kPredictsNextSubstep && substep_now + 1u < p.substeps) predict(i);
#endif
}

/// Ends the substep of a vertex without planes.
void project_free(uint i) {
  vec4 proposed = y[i], from = starts[i];
  start = from.xyz;
  end_substep(i, proposed, proposed.w > 0.0 ? within(i, proposed.xyz, from.w) : proposed.xyz);
}

/// All lanes of a cluster test the vertex's planes together. If it is behind a plane, the first lane projects it.
void project(uint i, bool valid) {
  vec4 proposed = vec4(0.0), from = vec4(0.0);
  float smallest = 1e30;
  if (valid) {
    proposed = y[i];
    from = starts[i];
  }
  start = from.xyz;
  vec3 at = proposed.xyz;
  if (proposed.w > 0.0) {
    at = within(i, at, from.w);
  }
  bool behind = PLANES > 0u || SELF != 0u || (SHAPES > 0u && valid && touched[NEEDS_PROJECTION(i)] != 0u);
  if (proposed.w > 0.0 && (behind || at != proposed.xyz)) {
    uint first = vertex_triangles[i];
    end_vertex_triangle = vertex_triangles[i + 1u];
    first_vertex_triangle = first + cluster_lane();
    vertex_triangle_step = LANES_PER_VERTEX;
    smallest = min_plane_distance(at);
    first_vertex_triangle = first;
    vertex_triangle_step = 1u;
  }
  smallest = cluster_min(smallest);
  if (!valid || cluster_lane() != 0u) return;
  if (behind && SHAPES > 0u) touched[NEEDS_PROJECTION(i)] = 0u;
  if (proposed.w > 0.0 && !(smallest >= 0.0)) at = project_to_feasible(i, at, from.w);
  end_substep(i, proposed, at);
}

/// Thread `first` of `at_once` threads and its cluster process their part of the vertices.
void project_all(uint first, uint at_once) {
  bool all_of_them = PLANES > 0u || SELF != 0u;
  for (uint i = first; !all_of_them && i < VERTICES; i += at_once)
    if (SHAPES == 0u || touched[PAIR_COUNT(i)] == 0u) project_free(i);
  uint count = all_of_them ? VERTICES : SHAPES == 0u ? 0u : frame_state.touched_vertices;
  for (uint n = first / LANES_PER_VERTEX; subgroupAny(n < count); n += at_once / LANES_PER_VERTEX) {
    bool valid = n < count;
    uint i = n;
    if (valid && !all_of_them) i = touched[n];
    project(i, valid);
  }
}

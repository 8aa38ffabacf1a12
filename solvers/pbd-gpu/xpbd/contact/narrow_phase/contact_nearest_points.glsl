// Nearest points of an active pair at the substep's start, and a contact there.

/// Whether a cloth triangle lies on one side of a static triangle's plane; then only the cloth's vertices touch it.
bool separated_by_face(uvec4 e, inout PairState s) {
  if (shape.count != 3u || shape.is_kinematic != 0u || shape.radius != 0.0 || e.w != 3u) return false;
  load_shape(t_begin);
  vec3 n = cross(shape_points[1] - shape_points[0], shape_points[2] - shape_points[0]);
  float l = length(n);
  if (!(l > 0.0)) return false;
  n /= l;
  vec3 start = vec3(0.0), end = vec3(0.0);
  [[unroll]] for (uint c = 0u; c < 3u; ++c) {
    start[c] = dot(n, cloth[c] - shape_points[0]);
    end[c] = dot(n, y[e[c]].xyz - around - shape_points[0]);
  }
  if (max(start.x, max(start.y, start.z)) < 0.0) {
    n = -n;
    start = -start;
    end = -end;
  }
  float gap = min(start.x, min(start.y, start.z));
  if (!(gap >= max(MIN_SEPARATION_M, kStaticMarginFactor * shape.margin) &&
        min(end.x, min(end.y, end.z)) >= MIN_SEPARATION_M))
    return false;
  s.normal = vec4(n, gap);
  return true;
}

uint find_contact(uvec4 e, inout PairState s) {
  s.correction = vec4(0.0);
  around = starts[e.x].xyz;
  [[unroll]] for (uint c = 0u; c < 3u; ++c) cloth[c] = starts[e[min(c, e.w - 1u)]].xyz - around;
  corners = e.w;
  if (separated_by_face(e, s)) return PAIR_TESTED | PAIR_PLANE;
  Nearest r = nearest_at(t_begin, t_end, s.normal.xyz);
  if (!(r.gap > 0.0)) {
    if (response_round == FIRST_ROUND && writes_pair()) atomicAdd(diagnostics.inside, 1u);
    s.normal.w = 0.0;
    return PAIR_TESTED;
  }
  float gap = r.gap - shape.radius;
  s.normal = vec4(r.n, gap);
  // From the cloth's point and the gap, not from the convex shape's point: on a large face that point has lost digits,
  // and its error is large enough, compared with a substep's fall, to falsify the normal force.
  vec3 on_cloth = r.on_cloth.x * cloth[0] + r.on_cloth.y * cloth[1] + r.on_cloth.z * cloth[2];
  s.weights = vec4(r.on_cloth, dot(r.n, on_cloth + r.displacement + around) - gap);
  s.displacement_or_plane = vec4(r.displacement, min(kept_margin(e, s.weights.xyz), gap));
  return PAIR_TESTED | PAIR_NEAREST | (e.w == 3u ? PAIR_PLANE : 0u);
}

/// Computes the nearest points of an active pair, unless round 0 has done so, and its contact's correction.
void process_pair(uint k) {
  uvec4 pair = pairs[k];
  uvec4 e = primitives[pair.x];
  PairState s = states[k];
  shape = shapes[pair.y];
  if ((pair.z & PAIR_NEAREST) == 0u) {
    pair.z = find_contact(e, s);
    if (writes_pair()) pairs[k].z = pair.z;
  }
  s.correction = (pair.z & PAIR_NEAREST) != 0u ? contact_correction(e, s) : vec4(0.0);
  if (!writes_pair()) return;
  mark_correction(k, e, s.correction != vec4(0.0), false);
  states[k] = s;
}

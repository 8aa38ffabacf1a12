// Selects a pair's plane: with the normal at the start if that also separates the proposed positions, otherwise with a
// normal that separates both start and end, if one is found. Vertices move on straight lines, so a plane that separates
// a pair at start and end separates it in between.
const float kUnsure = 5.0;  // [rounding errors] a vertex at most this far in front of a plane may be behind it
vec3 starting[3], proposed[3];

float highest_of_shape(vec3 n) { return highest_point(n, t_end) + shape.radius; }
float gap_at_start(vec3 n) { return gap_along(n, starting[0], starting[1], starting[2], t_begin) - shape.radius; }
float gap_at_end(vec3 n) { return gap_along(n, proposed[0], proposed[1], proposed[2], t_end) - shape.radius; }

/// Finds a normal with gaps of at least `smallest` at start and end: the end's normal, or a blend of it with `old`.
bool find_alternative_normal(vec3 old, float smallest, out vec3 n) {
  [[unroll]] for (uint c = 0u; c < 3u; ++c) cloth[c] = proposed[c];
  corners = 3u;
  Nearest r = nearest_at(t_end, t_end, vec3(0.0));
  if (!(r.gap > shape.radius)) return false;
  const float kBlends[4] = float[4](1.0, 0.5, 0.75, 0.25);
  for (uint k = 0u; k < 4u; ++k) {
    n = mix(old, r.n, kBlends[k]);
    float l = length(n);
    if (!(l > 0.2)) continue;
    n /= l;
    if (gap_at_start(n) >= smallest && gap_at_end(n) >= smallest) return true;
  }
  return false;
}

void select_plane(uint k) {
  uvec4 pair = pairs[k];
  if ((pair.z & PAIR_PLANE) == 0u) return;
  uvec4 e = primitives[pair.x];
  shape = shapes[pair.y];
  vec4 normal = states[k].normal;
  around = starts[e.x].xyz;
  [[unroll]] for (uint c = 0u; c < 3u; ++c) {
    starting[c] = starts[e[c]].xyz - around;
    proposed[c] = y[e[c]].xyz - around;
  }
  vec3 n = normal.xyz, other;
  float smallest = min(normal.w, MIN_SEPARATION_M);  // below 0: the pair starts inside the radius, and goes no deeper
  if (gap_at_end(n) < smallest && find_alternative_normal(n, smallest, other)) {
    n = other;
    if (writes_pair()) states[k].normal.xyz = n;
  }
  vec4 plane = vec4(n, highest_of_shape(n) + dot(n, around) + smallest);
  if (!writes_pair()) return;
  states[k].displacement_or_plane = plane;
  states[k].correction = vec4(0.0);  // multipliers of contact_project
  [[unroll]] for (uint c = 0u; c < 3u; ++c)
    if (!(dot(n, y[e[c]].xyz) - plane.w > kUnsure * ROUNDING_M)) touched[NEEDS_PROJECTION(e[c])] = 1u;
}

// A plane for a pair that was looked at: across its start's normal where the proposed end is before it, else across any that
// parts both ends of the way. Vertices go straight, so what a plane parts at both ends it parts in between.
const float kUnsure_m = 1e-6;  // distances that rounding decides
vec3 starting[3], proposed[3];

float farthest_point(vec3 n) { return highest_point(n, t_end) + piece.radius; }
float gap_at_start(vec3 n) { return gap_along(n, starting[0], starting[1], starting[2], t_begin) - piece.radius; }
float gap_at_end(vec3 n) { return gap_along(n, proposed[0], proposed[1], proposed[2], t_end) - piece.radius; }

/// The normal at the end, or half-way to it.
bool another(vec3 old, float least, out vec3 n) {
  [[unroll]] for (uint c = 0u; c < 3u; ++c) cloth[c] = proposed[c];
  corners = 3u;
  Nearest r = nearest_at(t_end, t_end, vec3(0.0));
  if (!(r.gap > piece.radius)) return false;
  const float kBlends[4] = float[4](1.0, 0.5, 0.75, 0.25);
  for (uint k = 0u; k < 4u; ++k) {
    n = mix(old, r.n, kBlends[k]);
    float l = length(n);
    if (!(l > 0.2)) continue;
    n /= l;
    if (gap_at_start(n) >= least && gap_at_end(n) >= least) return true;
  }
  return false;
}

void choose(uint k) {
  uvec4 pair = LOAD16(pairs, k);
  if ((pair.z & PAIR_PLANE) == 0u) return;
  uvec4 e = LOAD16(elements, pair.x);
  piece = pieces[pair.y];
  vec4 normal = states[k].normal;
  around = starts[e.x].xyz;
  [[unroll]] for (uint c = 0u; c < 3u; ++c) {
    starting[c] = starts[e[c]].xyz - around;
    proposed[c] = y[e[c]].xyz - around;
  }
  vec3 n = normal.xyz, other;
  float least = min(normal.w, kGuard_m);  // below 0: inside a radius, and no deeper
  if (gap_at_end(n) < least && another(n, least, other)) {
    n = other;
    if (writes_pair()) states[k].normal.xyz = n;
  }
  vec4 plane = vec4(n, farthest_point(n) + dot(n, around) + least);
  if (!writes_pair()) return;
  states[k].way = plane;
  states[k].push = vec4(0.0);  // multipliers of plane_project
  [[unroll]] for (uint c = 0u; c < 3u; ++c)
    if (!(dot(n, y[e[c]].xyz) - plane.w > kUnsure_m)) touched[BEFORE_A_PLANE(e[c])] = 1u;
}

// Implicit tension (xpbd/time/README.md): before a chain's links are solved, zero-length springs with the links'
// tension move its vertices. Their system in the vertices' displacements is diagonally dominant at any tension.
float turn_lower[K], turn_diagonal[K], turn_upper[K];
vec3 turn_right[K];
void exchange_row(uint n, float a, float c, vec3 d, out float a_below, out float c_below, out vec3 d_below,
                  out float a_above, out float c_above, out vec3 d_above) {
  vec4 below, above;
  exchange(vec4(d, 0.0), n, below, above);
  d_below = below.xyz;
  d_above = above.xyz;
  exchange(vec4(a, c, 0.0, 0.0), n, below, above);
  a_below = below.x; c_below = below.y;
  a_above = above.x; c_above = above.y;
}
void to_part(inout float a, inout float c, inout vec3 d) {
  d = to_part(vec4(d, 0.0)).xyz;
  vec4 row = to_part(vec4(a, c, 0.0, 0.0));
  a = row.x; c = row.y;
}
void from_part(inout vec3 d, out vec3 d_below) {
  vec4 below;
  d = from_part(vec4(d, 0.0), below).xyz;
  d_below = below.xyz;
}
#define SOLVE solve_turn
#define MATRIX float
#define VECTOR vec3
#define M K
#define LOWER turn_lower
#define DIAGONAL turn_diagonal
#define UPPER turn_upper
#define RIGHT turn_right
#include "xpbd/lines/tridiagonal.glsl"

/// Solves the links only for `pull`, their tension / length, then moves the vertices by springs of that tension.
void turn_by_tension(float smallest) {
  [[unroll]] for (uint k = 0u; k < K; ++k) pull[k] = 0.0;
  link_equations(smallest);
  float lambda_below;
  solve_links(32u, lambda_below);
  [[unroll]] for (uint k = 0u; k < K; ++k)
    pull[k] = direction[k] != vec3(0.0) ? max(-link_right[k], 0.0) / link_length[k] : 0.0;
  vec4 below, above, none;
  exchange(vec4(pos[K - 1u], pull[K - 1u]), 1u, below, none);
  exchange(vec4(pos[0], 0.0), 1u, none, above);
  if (lane == 0u) below.w = 0.0;
  [[unroll]] for (uint k = 0u; k < K; ++k) {
    vec4 last = below;
    vec3 next = above.xyz;
    if (k > 0u) last = vec4(pos[k - 1u], pull[k - 1u]);
    if (k + 1u < K) next = pos[k + 1u];
    float before = w[k] * last.w, after = w[k] * pull[k];
    turn_lower[k] = -before;
    turn_upper[k] = -after;
    turn_diagonal[k] = 1.0 + before + after;
    turn_right[k] = before * (last.xyz - pos[k]) + after * (next - pos[k]);
  }
  vec3 step_below;
  solve_turn(32u, step_below);
  [[unroll]] for (uint k = 0u; k < K; ++k)
    if (w[k] > 0.0) move(k, turn_right[k]);
}

// Start of a substep for the thread's vertices: v += g h - (1 - e^{-c h}) v, x += h v, both in compensated sums (Knuth's
// two-sum): with thousands of substeps a second the increments fall below the last bit of x and v, and plain sums would
// freeze or drift. Then tethers (Kim, Chentanez & Mueller 2012): no vertex is farther from a pinned one than the cloth
// between them is long. `anchor(v, k)` gives where vertex v,
// which is pinned, is, for the thread's vertex k.
vec3 rest_pos[K], rest_vel[K];  // what the last sums could not hold

#include "sums.glsl"

/// The nearest vertex of a rectangle of pinned ones.
uvec2 nearest(uvec2 at, uint first, uint last) {
  return clamp(at, uvec2(first & 0xffffu, first >> 16u), uvec2(last & 0xffffu, last >> 16u));
}

/// Without shear stiffness the cloth reaches along its threads only.
vec3 tethered(vec3 position, uvec2 at, uvec2 to, vec3 end) {
  vec2 way = abs(vec2(ivec2(at) - ivec2(to))) * vec2(p.rest_u, p.rest_v);
  float reach = p.tether_stretch * (kShears ? length(way) : way.x + way.y);
  vec3 e = position - end;
  float square = dot(e, e);
  return square > reach * reach ? e * (reach * inversesqrt(square) - 1.0) : vec3(0.0);
}

void integrate() {
  [[unroll]] for (uint k = 0u; k < K; ++k) {
    uvec2 at = vertex(lane * K + k), to[4];
    vec3 end[4];
    // Where pins are is fetched first: nothing below waits for it.
    if (TETHERS > 0u) end[0] = anchor(to[0] = nearest(at, TETHER_0, TETHER_0_LAST), k);
    if (TETHERS > 1u) end[1] = anchor(to[1] = nearest(at, TETHER_1, TETHER_1_LAST), k);
    if (TETHERS > 2u) end[2] = anchor(to[2] = nearest(at, TETHER_2, TETHER_2_LAST), k);
    if (TETHERS > 3u) end[3] = anchor(to[3] = nearest(at, TETHER_3, TETHER_3_LAST), k);
    vec3 gain = p.gravity_h.xyz, sum, rest;
    if ((FEATURES & LINES_DAMPING) != 0u) gain -= p.loss * vel[k];
    bool is_free = w[k] > 0.0;
    two_sum(vel[k], gain + rest_vel[k], sum, rest);
    vel[k] = is_free ? sum : vel[k];
    rest_vel[k] = is_free ? rest : rest_vel[k];
    two_sum(pos[k], p.h * sum + rest_pos[k], sum, rest);
    pos[k] = is_free ? sum : pos[k];
    rest_pos[k] = is_free ? rest : rest_pos[k];
    [[unroll]] for (uint t = 0u; t < 4u; ++t)
      if (t < TETHERS && is_free) move(k, tethered(pos[k], at, to[t], end[t]));
  }
}

/// No vertex is faster than a fall across the cloth can make it: what a solve of few substeps throws, it does not keep.
void limit_speed() {
  if ((FEATURES & LINES_LIMIT_SPEED) == 0u) return;
  [[unroll]] for (uint k = 0u; k < K; ++k) {
    float square = dot(vel[k], vel[k]);
    if (square > p.speed_limit * p.speed_limit) vel[k] *= p.speed_limit * inversesqrt(square);
  }
}

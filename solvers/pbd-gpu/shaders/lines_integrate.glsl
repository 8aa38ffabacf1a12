// Start of a substep for the thread's vertices: v += g h - (1 - e^{-c h}) v, x += h v, both in compensated sums (Knuth's
// two-sum): with thousands of substeps a second the increments fall below the last bit of x and v, and plain sums would
// freeze or drift. Then tethers (Kim, Chentanez & Mueller 2012): no vertex is farther from a pinned one than the cloth
// between them is long. `anchor(v)` gives where vertex v, which is pinned, is.
vec3 rest_pos[K], rest_vel[K];  // what the last sums could not hold

/// a + b = sum + rest exactly.
void two_sum(vec3 a, vec3 b, out vec3 sum, out vec3 rest) {
  precise vec3 s = a + b;
  precise vec3 part = s - a;
  precise vec3 left = (a - (s - part)) + (b - part);
  sum = s;
  rest = left;
}

/// To the nearest vertex of a rectangle of pinned ones. Without shear stiffness the cloth reaches along its threads only.
void tether(uint k, uvec2 at, uint first, uint last) {
  uvec2 a = clamp(at, uvec2(first & 0xffffu, first >> 16u), uvec2(last & 0xffffu, last >> 16u));
  vec2 way = abs(vec2(ivec2(at) - ivec2(a))) * vec2(p.rest_u, p.rest_v);
  float reach = p.tether_stretch * (kShears ? length(way) : way.x + way.y);
  vec3 e = pos[k] - anchor(a);
  float l = length(e);
  if (l > reach) move(k, e * (reach / l - 1.0));
}

void integrate() {
  [[unroll]] for (uint k = 0u; k < K; ++k) {
    if (w[k] == 0.0) continue;
    vec3 gain = p.gravity_h.xyz, sum, rest;
    if ((FEATURES & LINES_DAMPING) != 0u) gain -= p.loss * vel[k];
    two_sum(vel[k], gain + rest_vel[k], sum, rest);
    vel[k] = sum;
    rest_vel[k] = rest;
    two_sum(pos[k], p.h * sum + rest_pos[k], sum, rest);
    pos[k] = sum;
    rest_pos[k] = rest;
    uvec2 at = vertex(lane * K + k);
    if (TETHERS > 0u) tether(k, at, TETHER_0, TETHER_0_LAST);
    if (TETHERS > 1u) tether(k, at, TETHER_1, TETHER_1_LAST);
    if (TETHERS > 2u) tether(k, at, TETHER_2, TETHER_2_LAST);
    if (TETHERS > 3u) tether(k, at, TETHER_3, TETHER_3_LAST);
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

// Start of a substep for the thread's vertices: prediction, then tethers (Kim, Chentanez & Mueller 2012), which limit a
// vertex's distance from pinned vertices to the length of the cloth between them. The including file defines
// `anchor(v, k)`: position of pinned vertex v, for the tether of the thread's vertex k.
vec3 rest_pos[K], rest_vel[K];  // rounding errors of the last sums
vec3 last_pos[K], last_vel[K];  // state before the last substep, if kUsesBdf2

/// The vertex of a rectangle of pinned vertices that is nearest to vertex `at`.
uvec2 nearest(uvec2 at, uint first, uint last) {
  return clamp(at, uvec2(first & 0xffffu, first >> 16u), uvec2(last & 0xffffu, last >> 16u));
}

/// Maximum distance of vertex `at` from pinned vertex `to` [m]; without shear stiffness measured along warp and weft.
/// `first`, `last`: corners of the pinned rectangle; its longer side (at least one cell) is the width of the support.
float reach_of(uvec2 at, uvec2 to, uint first, uint last) {
  vec2 rest = vec2(p.rest_u, p.rest_v), across = abs(vec2(ivec2(at) - ivec2(to))) * rest;
  float r = kShears ? length(across) : across.x + across.y, reach = p.tether_stretch * r;
  if (p.gravity_h.w == 0.0) return reach;
  vec2 span = vec2(ivec2(last & 0xffffu, last >> 16u) - ivec2(first & 0xffffu, first >> 16u)) * rest;
  float width = max(max(span.x, span.y), max(rest.x, rest.y));
  return reach + prediction_fall() + p.gravity_h.w * log(1.0 + r / width);
}

void integrate() {
  [[unroll]] for (uint k = 0u; k < K; ++k) {
    uvec2 at = vertex(lane * K + k), to[4];
    vec3 end[4];
    // Loads the pins' positions first, so that the latency overlaps with the prediction below.
    if (TETHERS > 0u) end[0] = anchor(to[0] = nearest(at, TETHER_0, TETHER_0_LAST), k);
    if (TETHERS > 1u) end[1] = anchor(to[1] = nearest(at, TETHER_1, TETHER_1_LAST), k);
    if (TETHERS > 2u) end[2] = anchor(to[2] = nearest(at, TETHER_2, TETHER_2_LAST), k);
    if (TETHERS > 3u) end[3] = anchor(to[3] = nearest(at, TETHER_3, TETHER_3_LAST), k);
    if (w[k] > 0.0) fall(pos[k], vel[k], rest_pos[k], rest_vel[k], last_pos[k], last_vel[k]);
    const uint first[4] = uint[4](TETHER_0, TETHER_1, TETHER_2, TETHER_3),
               last[4] = uint[4](TETHER_0_LAST, TETHER_1_LAST, TETHER_2_LAST, TETHER_3_LAST);
    [[unroll]] for (uint t = 0u; t < 4u; ++t)
      if (t < TETHERS && w[k] > 0.0) move(k, tethered(pos[k], end[t], reach_of(at, to[t], first[t], last[t])));
  }
}

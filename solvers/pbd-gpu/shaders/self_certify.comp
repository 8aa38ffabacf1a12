#version 450
// The part of their displacement that all vertices may move at once so that nothing crosses: wherever a vertex and a triangle, or two edges,
// are apart by a plane at the substep's start and at its end across the same direction, they were apart all along, since vertices go
// in straight lines. The least part of all pairs, whatever order they come in.
#include "common.glsl"
layout(std430, binding = BIND_STARTS) readonly buffer Starts { vec4 starts[]; };
layout(std430, binding = BIND_POSITIONS) readonly buffer Positions { vec4 x[]; };
layout(std430, binding = BIND_BLOCKS) readonly buffer Blocks { vec4 blocks[]; };
layout(std430, binding = BIND_NEAR) readonly buffer Near { uint near[]; };
layout(std430, binding = BIND_PART) buffer Part { uint part[]; };
layout(push_constant) uniform Push { SelfConstants p; };
#include "self.glsl"
#include "self_pieces.glsl"

float free_share(float before) {
  float left = before < kNear * p.thickness_m ? kLeftNear : kLeft;
  return clamp(1.0 - kLast * p.thickness_m / before, 0.0, 1.0 - left);
}

/// The part of the displacement over which a plane across n is certain to stand between the two.
float by_plane(bool edges, vec3 n) {
  float l = length(n);
  if (!(l > 0.0)) return 0.0;
  float before = gap_along(edges, n / l, from), after = gap_along(edges, n / l, to), share = free_share(before);
  if (!(before > 0.0)) return 0.0;
  return after >= (1.0 - share) * before ? 1.0 : share * before / (before - after);
}

/// The part of the displacement over which no point of one comes as near to a point of the other as they are, whatever the direction.
float by_distance(bool edges, float d) {
  float most = 0.0;
  for (uint a = 0u; a < (edges ? 2u : 1u); ++a)
    for (uint b = edges ? 2u : 1u; b < 4u; ++b) most = max(most, distance(to[a] - from[a], to[b] - from[b]));
  return free_share(d) * d / max(most, 1e-30);
}

void meet(bool edges) {
  // Held vertices follow their prescribed positions; vertices that these meet can only be pushed.
  for (uint k = 0u; k < 4u; ++k)
    if (inverse_mass[k] == 0.0 && to[k] != from[k]) return;
  bool inside;
  vec3 n = weighted(weights_of(edges, from, inside), from);
  float d = length(n);
  // Pieces that touch already are not kept apart.
  if (!(d > kTouching * p.thickness_m)) return;
  float most = by_plane(edges, n);
  if (most == 1.0) return;
  most = max(most, max(by_plane(edges, weighted(weights_of(edges, to, inside), to)), by_distance(edges, d)));
  if (most >= 1.0) return;
  COUNT_ATOMIC
  atomicMin(part[0], floatBitsToUint(most));
}

void main() {
  uint s = item(), n = p.columns * p.rows;
  if (s >= 4u * n) return;
  uint i = s % n;
  vec3 low, high;
  if (s < n) {
    if (start_with(KIND_VERTEX, 0u, i, low, high)) meet_all(KIND_VERTEX, 0u, i, low, high, false);
  } else {
    uint family = s / n - 1u;
    if (start_with(KIND_EDGE, family, i, low, high)) meet_all(KIND_EDGE, 3u * i + family, i, low, high, true);
  }
}

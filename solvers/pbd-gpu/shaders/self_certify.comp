#version 450
// Which part of their way all vertices may go at once so that nothing crosses: wherever a vertex and a triangle, or two edges,
// are apart by a plane at the substep's start and at its end across the same direction, they were apart all along, since vertices go
// in straight lines. The least part of all pairs, whatever order they come in.
#define COUNTER_BINDING 5
#extension GL_GOOGLE_include_directive : require
#include "common.glsl"
layout(std430, binding = 0) readonly buffer Starts { vec4 starts[]; };
layout(std430, binding = 1) readonly buffer Positions { vec4 x[]; };
layout(std430, binding = 2) readonly buffer Blocks { vec4 blocks[]; };
layout(std430, binding = 3) readonly buffer Near { uint near[]; };
layout(std430, binding = 4) buffer Part { uint part[]; };
layout(push_constant) uniform Push { SelfConstants p; };
#include "self.glsl"
#include "self_pieces.glsl"

/// The part of the way over which a plane across n is certain to stand between the two.
float certain(bool edges, vec3 n) {
  float l = length(n);
  if (!(l > 0.0)) return 0.0;
  float before = gap_along(edges, n / l, from), after = gap_along(edges, n / l, to);
  if (!(before > kTouching * p.thickness_m)) return 0.0;
  return after >= kLeft * before ? 1.0 : (1.0 - kLeft) * before / (before - after);
}

void meet(bool edges) {
  // What is held goes where it is held, and whoever is in its way can only be pushed.
  for (uint k = 0u; k < 4u; ++k)
    if (inverse_mass[k] == 0.0 && to[k] != from[k]) return;
  bool inside;
  vec3 n = weighted(weights_of(edges, from, inside), from);
  // What touches already is nobody's to keep apart.
  if (!(length(n) > 2.0 * kTouching * p.thickness_m)) return;
  float most = certain(edges, n);
  if (most == 1.0) return;
  most = max(most, certain(edges, weighted(weights_of(edges, to, inside), to)));
  if (most == 1.0 || most == 0.0) return;
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

#version 450
// What every vertex, triangle and edge of the cloth corrections of its own vertices, so that no other piece is nearer than the
// thickness at the substep's end and nothing comes nearer: by gathering, each pair seen from both its sides, with sums in a fixed
// order. Corrections of ways and of velocities are apart: a push is no velocity, or layers would pop.
#include "common.glsl"
layout(std430, binding = BIND_STARTS) readonly buffer Starts { vec4 starts[]; };
layout(std430, binding = BIND_POSITIONS) readonly buffer Positions { vec4 x[]; };
layout(std430, binding = BIND_VELOCITIES) readonly buffer Velocities { vec4 v[]; };
layout(std430, binding = BIND_BLOCKS) readonly buffer Blocks { vec4 blocks[]; };
layout(std430, binding = BIND_NEAR) readonly buffer Near { uint near[]; };
layout(std430, binding = BIND_PROPOSED) writeonly buffer Corrections { vec4 corrections[]; };  // two a slot: displacement, velocity; w: their weight
layout(push_constant) uniform Push { SelfConstants p; };
#include "self.glsl"
#include "self_pieces.glsl"

uint own_first, own_count;
vec4 displacement_sum[3], velocity_sum[3];

/// The mean of all corrections, weighted by how much each asks.
void add(inout vec4 sum, vec3 correction) {
  float l = length(correction);
  sum += vec4(l * correction, l);
}

void meet(bool edges) {
  bool inside;
  vec4 w = weights_of(edges, from, inside);
  // Where an edge's end is nearest, the vertex has seen it.
  if (!inside) return;
  vec3 n = weighted(w, from);
  float d = length(n), mass = dot(w * w, inverse_mass);
  if (!(d > kTouching * p.thickness_m) || !(mass > 0.0)) return;
  n /= d;
  float end = dot(n, weighted(w, to));
  if (!(end < (1.0 + kSlack) * p.thickness_m)) return;
  vec3 velocities[4];
  for (uint k = 0u; k < 4u; ++k) velocities[k] = LOAD16(v, who[k]).xyz;
  float wanted = d < p.thickness_m ? mix(d, p.thickness_m, kPush) : p.thickness_m;
  vec3 displacement = max(0.0, wanted - end) * n, relative = weighted(w, velocities);
  float approach = max(0.0, -dot(relative, n));
  vec3 gain = approach * n;
  if (p.friction > 0.0) {
    vec3 slip = relative - dot(relative, n) * n, slide = weighted(w, to) - weighted(w, from);
    slide -= dot(slide, n) * n;
    float most = p.friction * approach, speed = length(slip), l = length(slide);
    if (speed > 0.0) gain -= slip * min(1.0, most / speed);
    if (l > 0.0) displacement -= slide * min(1.0, most * p.h / l);
  }
  for (uint k = 0u; k < own_count; ++k) {
    float share = w[own_first + k] * inverse_mass[own_first + k] / mass;
    add(displacement_sum[k], share * displacement);
    add(velocity_sum[k], share * gain);
  }
}

/// Written out for every kind, so that no loop and no index over the vertices of a piece is left in the kernel.
void propose(uint kind, uint family, uint i, uint slot) {
  vec3 low, high;
  if (!start_with(kind, family, i, low, high)) return;
  own_first = kind == KIND_TRIANGLE ? 1u : 0u;
  own_count = kind == KIND_VERTEX ? 1u : kind == KIND_TRIANGLE ? 3u : 2u;
  for (uint k = 0u; k < 3u; ++k) displacement_sum[k] = velocity_sum[k] = vec4(0.0);
  meet_all(kind, 0u, i, low, high, false);
  for (uint k = 0u; k < own_count; ++k) {
    STORE16(corrections, 2u * (slot + k), displacement_sum[k]);
    STORE16(corrections, 2u * (slot + k) + 1u, velocity_sum[k]);
  }
}

void main() {
  uint s = item(), n = p.columns * p.rows;
  if (s >= 6u * n) return;
  uint i = s % n, family = s / n;
  // Slots: of vertices, then three of each triangle, then two of each edge.
  if (family == 0u)
    propose(KIND_VERTEX, 0u, i, i);
  else if (family < 3u)
    propose(KIND_TRIANGLE, family - 1u, i, n + 3u * (s - n));
  else
    propose(KIND_EDGE, family - 3u, i, 7u * n + 2u * (s - 3u * n));
}

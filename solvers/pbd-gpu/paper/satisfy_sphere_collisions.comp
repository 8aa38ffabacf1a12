#version 450
// Kim, Ma & Hong 2025, 3.2.3: every particle against every ball.
#include "common/common.glsl"
#include "paper/particle_contact.glsl"
layout(std430, binding = BIND_SPHERES) readonly buffer Spheres { SphereShape spheres[]; };

void main() {
  uint i = item();
  if (i >= p.particles) return;
  vec4 particle = LOAD16(q, i);
  if (particle.w == 0.0) return;
  vec3 at = particle.xyz, from = FRICTION == 1u ? LOAD16(x, i).xyz : vec3(0.0);
  for (uint k = 0u; k < p.count; ++k) {
    SphereShape s = LOAD(32u, spheres, k);
    at = out_of_ball(at, from, s.center.xyz, s.radius + s.margin, s.friction);
  }
  STORE16(q, i, vec4(at, particle.w));
}

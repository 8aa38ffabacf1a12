#version 450
// Kim, Ma & Hong 2025, 3.2.3: every particle against every ball.
#include "common/common.glsl"
#include "paper/particle_contact.glsl"
layout(std430, binding = BIND_SPHERES) readonly buffer Spheres { SphereShape spheres[]; };

vec3 satisfied(vec3 at, vec3 from) {
  for (uint k = 0u; k < p.count; ++k) {
    SphereShape s = spheres[k];
    at = out_of_ball(at, from, s.center.xyz, s.radius + s.margin, s.friction);
  }
  return at;
}
#include "paper/each_particle.glsl"

#version 450
// Kim, Ma & Hong 2025, 3.2.5, Algorithm 3: every particle against every capsule of a hand, where the frame ends: the
// point of the segment that is nearest, and out to the radius.
#include "common/common.glsl"
#include "paper/particle_contact.glsl"
layout(std430, binding = BIND_CAPSULES) readonly buffer Capsules { CapsuleShape capsules[]; };

vec3 satisfied(vec3 at, vec3 from) {
  for (uint k = 0u; k < p.count; ++k) {
    vec4 a = capsules[k].a1, b = capsules[k].b1;
    vec3 ab = b.xyz - a.xyz;
    float squared = dot(ab, ab);
    float t = squared > 0.0 ? clamp(dot(at - a.xyz, ab) / squared, 0.0, 1.0) : 0.0;
    at = out_of_ball(at, from, a.xyz + t * ab, a.w, b.w);
  }
  return at;
}
#include "paper/each_particle.glsl"

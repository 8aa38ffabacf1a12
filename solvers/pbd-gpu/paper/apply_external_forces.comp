#version 450
// Kim, Ma & Hong 2025, 3.2.3: gravity onto the velocities. V.w = inverse mass, 0 where pinned.
#include "common/common.glsl"
layout(std430, binding = BIND_VELOCITIES) buffer Velocities { vec4 v[]; };
layout(push_constant) uniform Push { PaperConstants p; };

void main() {
  uint i = item();
  if (i >= p.particles) return;
  vec4 vel = v[i];
  if (vel.w == 0.0) return;
  v[i] = vec4(vel.xyz + p.gravity.xyz * p.h, vel.w);
}

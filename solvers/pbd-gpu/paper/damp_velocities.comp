#version 450
// Kim, Ma & Hong 2025, 3.2.3: velocities lose a fixed share a step.
#include "common/common.glsl"
layout(std430, binding = BIND_VELOCITIES) buffer Velocities { vec4 v[]; };
layout(push_constant) uniform Push { PaperConstants p; };

void main() {
  uint i = item();
  if (i >= p.particles) return;
  vec4 vel = v[i];
  v[i] = vec4(vel.xyz * p.keep, vel.w);
}

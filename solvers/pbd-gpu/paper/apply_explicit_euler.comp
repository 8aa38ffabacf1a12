#version 450
// Kim, Ma & Hong 2025, 3.2.3: predicted position. P.w = inverse mass.
#include "common/common.glsl"
layout(std430, binding = BIND_POSITIONS) readonly buffer Positions { vec4 x[]; };
layout(std430, binding = BIND_VELOCITIES) readonly buffer Velocities { vec4 v[]; };
layout(std430, binding = BIND_PREDICTED) writeonly buffer Bdf2 { vec4 q[]; };
layout(push_constant) uniform Push { PaperConstants p; };

void main() {
  uint i = item();
  if (i >= p.particles) return;
  vec4 vel = v[i];
  q[i] = vec4(x[i].xyz + vel.xyz * p.h, vel.w);
}

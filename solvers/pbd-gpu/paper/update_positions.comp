#version 450
// Kim, Ma & Hong 2025, 3.2.3: v = (q - x) / h, x = q.
#include "common/common.glsl"
layout(std430, binding = BIND_POSITIONS) buffer Positions { vec4 x[]; };
layout(std430, binding = BIND_VELOCITIES) writeonly buffer Velocities { vec4 v[]; };
layout(std430, binding = BIND_PREDICTED) readonly buffer Bdf2 { vec4 q[]; };
layout(std430, binding = BIND_SLIP) buffer Slip { vec4 slip[]; };
layout(push_constant) uniform Push { PaperConstants p; };
PAPER_CONSTANTS(SPECIALIZE)

void main() {
  uint i = item();
  if (i >= p.particles) return;
  vec4 to = q[i];
  vec4 from = x[i];
  vec3 displacement = to.xyz - from.xyz;
  if (FRICTION == 2u) {
    displacement -= slip[i].xyz;
    slip[i] = vec4(0.0);
  }
  v[i] = vec4(displacement / p.h, to.w);
  x[i] = to;
}

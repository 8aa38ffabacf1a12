#version 450
// The kernels of `paper` with one thread per particle (Kim, Ma & Hong 2025, 3.2.3), in the order of a step.
// CMakeLists.txt compiles this file once per kernel. .w of velocities and predictions: inverse mass, 0 if
// pinned.
#include "common/common.glsl"
layout(std430, binding = BIND_POSITIONS) buffer Positions { vec4 x[]; };
layout(std430, binding = BIND_VELOCITIES) buffer Velocities { vec4 v[]; };
layout(std430, binding = BIND_PREDICTED) buffer Predicted { vec4 q[]; };
layout(std430, binding = BIND_DELTAS) buffer Deltas { uvec4 d[]; };
layout(std430, binding = BIND_SLIP) buffer Slip { vec4 slip[]; };  // displacement that velocities leave out
layout(push_constant) uniform Push { PaperConstants p; };
PAPER_CONSTANTS(SPECIALIZE)

void main() {
  uint i = item();
  if (i >= p.particles) return;
#if defined(APPLY_EXTERNAL_FORCES)
  vec4 vel = v[i];
  if (vel.w == 0.0) return;
  v[i] = vec4(vel.xyz + p.gravity.xyz * p.h, vel.w);

#elif defined(DAMP_VELOCITIES)  // by a fixed fraction per step
  vec4 vel = v[i];
  v[i] = vec4(vel.xyz * p.keep, vel.w);

#elif defined(APPLY_EXPLICIT_EULER)
  vec4 vel = v[i];
  q[i] = vec4(x[i].xyz + vel.xyz * p.h, vel.w);

#elif defined(AVERAGE_CONSTRAINT_DELTAS)  // adds the mean to the predicted position; clears the sums
  uvec4 sum = d[i];
  if (sum.w == 0u) return;
  vec4 at = q[i];
  q[i] = vec4(at.xyz + p.relaxation * uintBitsToFloat(sum.xyz) / float(sum.w), at.w);
  d[i] = uvec4(0u);

#elif defined(UPDATE_POSITIONS)  // v = (q - x) / h, x = q
  vec4 to = q[i];
  vec4 from = x[i];
  vec3 displacement = to.xyz - from.xyz;
  if (FRICTION == 2u) {
    displacement -= slip[i].xyz;
    slip[i] = vec4(0.0);
  }
  v[i] = vec4(displacement / p.h, to.w);
  x[i] = to;
#endif
}

#version 450
#include "common/common.glsl"
layout(std430, binding = BIND_GRIPS) readonly buffer Grips { GripVertex grips[]; };
layout(std430, binding = BIND_POSITIONS) buffer Positions { vec4 x[]; };
layout(std430, binding = BIND_VELOCITIES) buffer Velocities { vec4 v[]; };
layout(push_constant) uniform Push { GripConstants p; };
#include "common/grip.glsl"

void main() {
  uint k = item();
  if (k < p.count) move_grip(k, p.fraction, p.per_frame_s);
}

#version 450
// Vertices that a hand holds go where it takes them, on a straight line through the frame, and have no inverse mass.
// Once let go they have theirs, and keep the position and velocity they had.
#extension GL_GOOGLE_include_directive : require
#include "common.glsl"
layout(std430, binding = BIND_GRIPS) readonly buffer Grips { GripVertex grips[]; };
layout(std430, binding = BIND_POSITIONS) buffer Positions { vec4 x[]; };
layout(std430, binding = BIND_VELOCITIES) buffer Velocities { vec4 v[]; };
layout(push_constant) uniform Push { GripConstants p; };

void main() {
  uint k = item();
  if (k >= p.count) return;
  GripVertex g = LOAD(48u, grips, k);
  vec4 at = LOAD16(x, g.vertex), vel = LOAD16(v, g.vertex);
  bool held = g.held != 0u;
  // Written so that fractions 0 and 1 give the very ends.
  vec3 to = g.from.xyz * (1.0 - p.fraction) + g.to.xyz * p.fraction;
  STORE16(x, g.vertex, held ? vec4(to, 0.0) : vec4(at.xyz, g.free_inverse_mass));
  STORE16(v, g.vertex, held ? vec4((g.to.xyz - g.from.xyz) * p.per_frame_s, 0.0) : vec4(vel.xyz, g.free_inverse_mass));
}

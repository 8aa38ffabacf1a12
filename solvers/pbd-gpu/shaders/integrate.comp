#version 450
// Start of a substep: v += g h - (1 - e^{-c h}) v, x += h v, both in compensated sums (Knuth's two-sum): with thousands of
// substeps a second the increments fall below the last bit of x and v, and plain sums would freeze or drift.
// X.w = inverse mass, 0 where pinned.
#define COUNTER_BINDING 4
#extension GL_GOOGLE_include_directive : require
#include "common.glsl"
layout(std430, binding = 0) buffer Positions { vec4 x[]; };
layout(std430, binding = 1) buffer Velocities { vec4 v[]; };
layout(std430, binding = 2) buffer PositionRests { vec4 rx[]; };  // what the last sum could not hold
layout(std430, binding = 3) buffer VelocityRests { vec4 rv[]; };
layout(push_constant) uniform Push { XpbdConstants p; };
layout(constant_id = 1) const uint DAMPING = 0u;

/// a + b = sum + rest exactly.
void two_sum(vec3 a, vec3 b, out vec3 sum, out vec3 rest) {
  precise vec3 s = a + b;
  precise vec3 part = s - a;
  precise vec3 left = (a - (s - part)) + (b - part);
  sum = s;
  rest = left;
}

void main() {
  uint i = item();
  if (i >= p.columns * p.rows) return;
  vec4 at = LOAD16(x, i);
  if (at.w == 0.0) return;
  vec3 vel = LOAD16(v, i).xyz, gain = p.gravity_h.xyz, sum, rest;
  if (DAMPING == 1u) gain -= p.loss * vel;
  two_sum(vel, gain + LOAD16(rv, i).xyz, sum, rest);
  STORE16(v, i, vec4(sum, 0.0));
  STORE16(rv, i, vec4(rest, 0.0));
  two_sum(at.xyz, p.h * sum + LOAD16(rx, i).xyz, sum, rest);
  STORE16(x, i, vec4(sum, at.w));
  STORE16(rx, i, vec4(rest, 0.0));
}

#version 450
// Bending along a grid line as a vector XPBD constraint C = x0 - 2 x1 + x2 of the quadratic energy
// E = (B w / 2 a^3) |C|^2 (Bergou et al. 2006 on a line): compliance a^3 / (B w), gradients 1, -2, 1.
#ifdef KEEP_MULTIPLIERS
#define COUNTER_BINDING 3
#else
#define COUNTER_BINDING 2
#endif
#extension GL_GOOGLE_include_directive : require
#include "common.glsl"
layout(std430, binding = 0) buffer Positions { vec4 x[]; };
layout(std430, binding = 1) buffer Velocities { vec4 v[]; };
#ifdef KEEP_MULTIPLIERS
layout(std430, binding = 2) buffer Multipliers { vec4 lambda[]; };  // of the constraint that begins at a vertex
#endif
layout(push_constant) uniform Push { XpbdConstants p; };
#include "grid_family.glsl"

void main() {
  uint k = item();
  if (k >= p.count) return;
  uvec2 at = first_vertex(k);
  uint i0 = index_of(at), i1 = i0 + step_of(), i2 = i1 + step_of();
  vec4 a = LOAD16(x, i0), b = LOAD16(x, i1), c = LOAD16(x, i2);
  float w = a.w + 4.0 * b.w + c.w;
  if (w == 0.0) return;
  // Two held vertices in a row are a clamp: its hinge bends half a cell, 2 B/a.
  bool clamp = b.w == 0.0 && (a.w == 0.0) != (c.w == 0.0);
  float alpha = (clamp ? 0.5 : 1.0) * compliance(at);
  vec3 C = a.xyz - 2.0 * b.xyz + c.xyz;
#ifdef KEEP_MULTIPLIERS
  uint im = p.multiplier_first + i0;
  vec3 before = p.iteration == 0u ? vec3(0.0) : LOAD16(lambda, im).xyz;
  C += alpha * before;
  STORE16(lambda, im, vec4(before - C / (w + alpha), 0.0));
#endif
  vec3 s = -C / (w + alpha);
  STORE16(x, i0, vec4(a.xyz + a.w * s, a.w));
  STORE16(x, i1, vec4(b.xyz - 2.0 * b.w * s, b.w));
  STORE16(x, i2, vec4(c.xyz + c.w * s, c.w));
  vec4 va = LOAD16(v, i0), vb = LOAD16(v, i1), vc = LOAD16(v, i2);
  STORE16(v, i0, vec4(va.xyz + (a.w / p.h) * s, 0.0));
  STORE16(v, i1, vec4(vb.xyz - (2.0 * b.w / p.h) * s, 0.0));
  STORE16(v, i2, vec4(vc.xyz + (c.w / p.h) * s, 0.0));
}

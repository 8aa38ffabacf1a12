#version 450
// XPBD distance constraint (Macklin, Müller & Chentanez 2016, eq. 18). With one iteration a substep (Macklin et al. 2019)
// the multiplier starts at 0 and is not kept; KEEP_MULTIPLIERS is the variant for more. The velocity takes the same
// correction over h instead of being derived anew.
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
layout(std430, binding = 2) buffer Multipliers { float lambda[]; };  // of the constraint that begins at a vertex
#endif
layout(push_constant) uniform Push { XpbdConstants p; };
#include "grid_family.glsl"

void main() {
  uint k = item();
  if (k >= p.count) return;
  uvec2 at = first_vertex(k);
  uint ia = index_of(at), ib = ia + step_of();
  vec4 a = LOAD16(x, ia), b = LOAD16(x, ib);
  float w = a.w + b.w;
  if (w == 0.0) return;
  vec3 d = b.xyz - a.xyz;
  float l = length(d);
  float alpha = compliance(at), C = l - p.rest_m;
#ifdef KEEP_MULTIPLIERS
  uint im = p.multiplier_first + ia;
  float before = p.iteration == 0u ? 0.0 : LOAD4(lambda, im);
  C += alpha * before;
  STORE4(lambda, im, before - (l > 0.0 ? C / (w + alpha) : 0.0));
#endif
  vec3 s = l > 0.0 ? d * (C / (l * (w + alpha))) : vec3(0.0);
  STORE16(x, ia, vec4(a.xyz + a.w * s, a.w));
  STORE16(x, ib, vec4(b.xyz - b.w * s, b.w));
  vec4 va = LOAD16(v, ia), vb = LOAD16(v, ib);
  STORE16(v, ia, vec4(va.xyz + (a.w / p.h) * s, 0.0));
  STORE16(v, ib, vec4(vb.xyz - (b.w / p.h) * s, 0.0));
}

#version 450
// Kim, Ma & Hong 2025, 3.2.3, after Müller et al. 2007, eqs. 10-11: one thread per constraint. The corrections of both
// ends are summed atomically, because constraints share particles. The article's shaders have no float atomics: an
// integer compare-and-swap of the float's bits is repeated until it succeeds.
#include "common/common.glsl"
layout(std430, binding = BIND_CONSTRAINTS) readonly buffer Constraints { DistanceConstraint c[]; };
layout(std430, binding = BIND_PREDICTED) readonly buffer Bdf2 { vec4 q[]; };
layout(std430, binding = BIND_DELTAS) buffer Deltas { uint d[]; };  // per particle: x, y, z as float bits, count
layout(push_constant) uniform Push { PaperConstants p; };

void add(uint at, float value) {
  uint seen = d[at];
  for (;;) {
    uint found = atomicCompSwap(d[at], seen, floatBitsToUint(uintBitsToFloat(seen) + value));
    if (found == seen) return;
    seen = found;
  }
}

void add_delta(uint particle, vec3 delta) {
  add(4u * particle, delta.x);
  add(4u * particle + 1u, delta.y);
  add(4u * particle + 2u, delta.z);
  atomicAdd(d[4u * particle + 3u], 1u);
}

void main() {
  uint k = item();
  if (k >= p.constraints) return;
  DistanceConstraint e = c[k];
  vec4 a = q[e.a], b = q[e.b];
  float w = a.w + b.w;
  if (w == 0.0) return;
  vec3 d_ab = b.xyz - a.xyz;
  float l = length(d_ab);
  // Coincident ends have no direction: they count in the average with a correction of 0.
  vec3 s = l > 0.0 ? d_ab * (p.stiffness * (l - e.rest_m) / (l * w)) : vec3(0.0);
  if (a.w > 0.0) add_delta(e.a, a.w * s);
  if (b.w > 0.0) add_delta(e.b, -b.w * s);
}

#version 450
// Kim, Ma & Hong 2025, 3.2.3: mean of a particle's corrections onto its predicted position; clears the sums.
#include "common/common.glsl"
layout(std430, binding = BIND_DELTAS) buffer Deltas { uvec4 d[]; };
layout(std430, binding = BIND_PREDICTED) buffer Bdf2 { vec4 q[]; };
layout(push_constant) uniform Push { PaperConstants p; };

void main() {
  uint i = item();
  if (i >= p.particles) return;
  uvec4 sum = d[i];
  if (sum.w == 0u) return;
  vec4 at = q[i];
  q[i] = vec4(at.xyz + p.relaxation * uintBitsToFloat(sum.xyz) / float(sum.w), at.w);
  d[i] = uvec4(0u);
}

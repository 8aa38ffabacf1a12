#version 450
// Start of a substep, a thread a vertex: where it would be without links and contact. Tethers come with the lines.
#extension GL_GOOGLE_include_directive : require
#include "common.glsl"
#include "plane_buffers.glsl"
#include "plane_vertices.glsl"

void main() {
  uint i = item();
  if (i >= p.vertices) return;
  vec4 at = LOAD16(x, i);
  vec3 vel = LOAD16(v, i).xyz;
  if (at.w > 0.0) at.xyz += p.h * (vel + p.gravity_h.xyz - p.loss * vel);
  STORE16(y, i, at);
  starts[i].w = farthest(i, at.xyz);
}

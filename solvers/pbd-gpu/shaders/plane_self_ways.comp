#version 450
// Twice a substep, a thread a triangle.
#include "common.glsl"
#include "plane_buffers.glsl"
// Of a triangle: the greatest displacement of its vertices in the last substep, and how far any of them may go in this one.
void ways_of_triangle(uint t) {
  uvec4 e = LOAD16(elements, t);
  vec2 most = vec2(0.0);
  for (uint c = 0u; c < 3u; ++c) most = max(most, vec2(LOAD4(ways, e[c]), LOAD16(starts, e[c]).w));
  STORE16(self_ways, t, vec4(most, 0.0, 0.0));
}

void main() {
  for (uint t = item(); t < TRIANGLES; t += stride()) ways_of_triangle(t);
}

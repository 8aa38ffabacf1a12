#version 450
// Per triangle: the maximum displacement of its vertices in the last substep, and how far any of them may go in this
// one. One thread per triangle, once per substep.
#include "xpbd/contact/contact_buffers.glsl"
void main() {
  for (uint t = item(); t < TRIANGLES; t += stride()) {
    uvec4 e = primitives[t];
    vec2 largest = vec2(0.0);
    for (uint c = 0u; c < 3u; ++c) largest = max(largest, vec2(vertex_displacement[e[c]], starts[e[c]].w));
    triangle_max_displacement[t] = vec4(largest, 0.0, 0.0);
  }
}

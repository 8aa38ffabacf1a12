#version 450
// Start of a substep, a thread a vertex.
#include "common.glsl"
#include "plane_buffers.glsl"
#include "plane_vertices.glsl"

void main() {
  uint i = item();
  if (i < VERTICES) predict(i);
  if (PIECES > 0u) forget_near(i, stride());
}

#version 450
// Predicted position of each vertex without constraints and contact. One thread per vertex, at a substep's start.
#include "xpbd/contact/contact_buffers.glsl"
#include "xpbd/contact/displacement_filter/contact_vertex_step.glsl"

void main() {
  uint i = item();
  if (i < VERTICES) predict(i);
  if (SHAPES > 0u) clear_active_bits(i, stride());
}

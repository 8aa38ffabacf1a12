#version 450
// Motion bounds of vertices. One thread per vertex, once per frame.
#include "xpbd/contact/contact_buffers.glsl"
#include "xpbd/contact/displacement_filter/contact_motion_bounds.glsl"

void main() {
  uint i = item();
  if (i >= VERTICES) return;
  float max_shape_displacement = max_displacement_of_shapes();
  motion_bound_of_vertex(i, max_shape_displacement);
  if (i != 0u) return;
  frame_state.max_shape_displacement = max_shape_displacement;
  vec3 along = drift();
  for (uint c = 0u; c < 3u; ++c) frame_state.drift[c] = along[c];
  frame_state.bound_fraction = 1.0;  // prefix_sum may cut it
  frame_state.touched_vertices = 0u;
  frame_state.active_pair_count[0] = frame_state.active_pair_count[1] = 0u;
}

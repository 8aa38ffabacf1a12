#version 450
// Clamps each vertex to its motion bound after the constraint solve. One thread per vertex.
#include "xpbd/contact/contact_buffers.glsl"
#include "xpbd/contact/displacement_filter/contact_vertex_step.glsl"

void main() {
  uint i = item();
  response_round = p.response_round;
  begin_substep(p.first_substep);
  if (i < VERTICES) clamp_to_motion_bound(i, x[i]);
  if (i == 0u && response_round == 1u && p.first_substep == 0u) frame_state.max_displacement = 0u;  // of the last frame
  if (SHAPES > 0u && (!SECOND_SOLVE || response_round < 2u)) clear_active_bits(i, stride());
}

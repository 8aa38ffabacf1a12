#version 450
// Projection of vertices onto their separating planes, at a substep's end. A cluster of lanes per vertex.
#define SUBGROUPS
#include "xpbd/contact/contact_buffers.glsl"
#include "xpbd/contact/subgroup_cluster.glsl"
#include "xpbd/contact/displacement_filter/contact_project.glsl"

void main() {
  begin_substep(p.first_substep);
  project_all(item(), stride());
  // For the next substep.
  if (item() == 0u) frame_state.active_pair_count[1] = frame_state.self_active = frame_state.self_contact_pairs = 0u;
}

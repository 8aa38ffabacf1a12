#version 450
// Separating plane of each active pair, before the projection. One thread per active pair.
#include "xpbd/contact/contact_buffers.glsl"
#include "xpbd/contact/narrow_phase/contact_distance.glsl"
#include "xpbd/contact/displacement_filter/contact_select_plane.glsl"

void main() {
  begin_substep(p.first_substep);
  for (uint n = item(); n < frame_state.active_pair_count[1]; n += stride()) select_plane(pairs[n].w);
}

#version 450
// Nearest points and the correction of each active pair, once or twice per substep. One thread per active pair.
#include "xpbd/contact/contact_buffers.glsl"
#include "xpbd/contact/narrow_phase/contact_distance.glsl"
#include "xpbd/contact/response/contact_correction.glsl"
#include "xpbd/contact/narrow_phase/contact_nearest_points.glsl"

void main() {
  response_round = p.response_round;
  begin_substep(p.first_substep);
  for (uint n = item(); n < frame_state.active_pair_count[min(response_round, 1u)]; n += stride())
    process_pair(pairs[n].w);
}

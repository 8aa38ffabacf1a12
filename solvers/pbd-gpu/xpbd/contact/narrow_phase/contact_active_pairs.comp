#version 450
// Active pairs, once per substep and twice with kinematic shapes. One thread per candidate pair.
#include "xpbd/contact/contact_buffers.glsl"
#include "xpbd/contact/narrow_phase/contact_distance.glsl"
#define ACTIVE_COUNT frame_state.active_pair_count[min(response_round, 1u)]
#include "xpbd/contact/narrow_phase/contact_active_pairs.glsl"

void main() {
  response_round = p.response_round;
  begin_substep(p.first_substep);
  if (item() == 0u && response_round > 0u) frame_state.active_pair_count[0] = 0u;
  for (uint k = item(); k < frame_state.pairs; k += stride())
    if (may_be_active(k) && is_active(k)) append_active(k, atomicAdd(ACTIVE_COUNT, 1u));
}

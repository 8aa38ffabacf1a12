#version 450
// A later round of response of the cloth with itself. One thread per active pair.
#include "xpbd/contact/contact_buffers.glsl"
#include "xpbd/contact/response/self_correction.glsl"

void main() {
  response_round = p.response_round;
  uint count = min(frame_state.self_active, ACTIVE_CAPACITY);
  for (uint k = item(); k < count; k += stride()) correct_self(k);
}

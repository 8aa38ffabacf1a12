#version 450
// A later round of response: corrections of contacts at the vertices' new positions. One thread per active pair.
#include "xpbd/contact/contact_buffers.glsl"
ConvexShape shape;
#include "xpbd/contact/response/contact_correction.glsl"
#include "xpbd/contact/response/contact_respond.glsl"

void main() {
  response_round = p.response_round;
  for (uint n = item(); n < frame_state.active_pair_count[1]; n += stride()) respond(pairs[n].w);
}

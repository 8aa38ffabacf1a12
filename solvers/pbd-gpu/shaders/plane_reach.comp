#version 450
// Start of a frame, a thread a vertex.
#include "common.glsl"
#include "plane_buffers.glsl"
#include "plane_reach.glsl"

void main() {
  uint i = item();
  if (i >= VERTICES) return;
  float carried = greatest_displacement();
  reach_of_vertex(i, carried);
  if (i != 0u) return;
  ledger.carried = carried;
  vec3 along = drift();
  for (uint c = 0u; c < 3u; ++c) ledger.drift[c] = along[c];
  ledger.reach = 1.0;  // plane_scan may cut it
  ledger.touched_vertices = 0u;
  ledger.asked[0] = ledger.asked[1] = 0u;
}

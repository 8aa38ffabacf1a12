#version 450
// Start of a frame, a thread a vertex.
#include "common.glsl"
#include "plane_buffers.glsl"
layout(std430, binding = BIND_POSITIONS) readonly buffer Positions { vec4 x[]; };
layout(std430, binding = BIND_VELOCITIES) readonly buffer Velocities { vec4 v[]; };
layout(std430, binding = BIND_GRIPS) readonly buffer Grips { GripVertex grips[]; };
layout(std430, binding = BIND_PREDICTED) writeonly buffer Proposed { vec4 y[]; };
layout(std430, binding = BIND_STARTS) writeonly buffer Starts { vec4 starts[]; };
layout(std430, binding = BIND_REACHES) writeonly buffer Reaches { vec4 reaches[]; };
layout(std430, binding = BIND_WAYS) writeonly buffer Ways { float ways[]; };
layout(std430, binding = BIND_LEDGER) buffer Ledger { ContactLedger ledger; };
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

#version 450
// Start of a frame: how far each vertex may go in it. The list of pairs is made for that, and vertices keep to it.
#extension GL_GOOGLE_include_directive : require
#include "common.glsl"
#include "plane_buffers.glsl"
layout(std430, binding = BIND_POSITIONS) readonly buffer Positions { vec4 x[]; };
layout(std430, binding = BIND_VELOCITIES) readonly buffer Velocities { vec4 v[]; };
layout(std430, binding = BIND_GRIPS) readonly buffer Grips { GripVertex grips[]; };
layout(std430, binding = BIND_STARTS) writeonly buffer Starts { vec4 starts[]; };
layout(std430, binding = BIND_REACHES) writeonly buffer Reaches { vec4 reaches[]; };
layout(std430, binding = BIND_SIDES) writeonly buffer Ways { float ways[]; };
layout(std430, binding = BIND_LEDGER) writeonly buffer Ledger { ContactLedger ledger; };

void main() {
  uint i = item();
  if (i >= p.vertices) return;
  float carried = 0.0;
  for (uint g = 0u; g < p.groups; ++g) carried = max(carried, LOAD16_OF(boxes[p.pieces + g].low).w);
  vec4 at = LOAD16(x, i);
  float reach = p.reach_m + 1.5 * length(LOAD16(v, i).xyz) * p.frame_s + carried;
  for (uint k = 0u; k < GRIPS; ++k) {
    GripVertex grip = LOAD(48u, grips, k);
    if (grip.vertex == i && grip.held != 0u) reach = max(reach, distance(at.xyz, grip.to.xyz));
  }
  STORE16(starts, i, vec4(at.xyz, 0.0));
  STORE16(reaches, i, vec4(at.xyz, reach));
  STORE4(ways, i, 0.0);
  if (i != 0u) return;
  ledger.carried = carried;
  ledger.reach = 1.0;  // plane_scan may cut it
}

#version 450
// A substep's end, a thread a vertex; SHUFFLES: a team of lanes.
#include "common.glsl"
#include "plane_buffers.glsl"
layout(std430, binding = BIND_POSITIONS) writeonly buffer Positions { vec4 x[]; };  // w: inverse mass in the lines
layout(std430, binding = BIND_VELOCITIES) buffer Velocities { vec4 v[]; };
layout(std430, binding = BIND_PREDICTED) readonly buffer Proposed { vec4 y[]; };  // w: inverse mass
layout(std430, binding = BIND_REACHES) readonly buffer Reaches { vec4 reaches[]; };
layout(std430, binding = BIND_STARTS) buffer Starts { vec4 starts[]; };  // at the substep's start; w: farthest it may go
layout(std430, binding = BIND_FANS) readonly buffer Fans { uint fans[]; };
layout(std430, binding = BIND_RANGES) readonly buffer Ranges { uvec4 ranges[]; };
layout(std430, binding = BIND_LEDGER) buffer Ledger { ContactLedger ledger; };
layout(std430, binding = BIND_TOUCHED) buffer Touched { uint touched[]; };
layout(std430, binding = BIND_NEAR_BITS) readonly buffer NearBits { uint near_bits[]; };
layout(std430, binding = BIND_PAIRS) readonly buffer Pairs { uvec4 pairs[]; };
layout(std430, binding = BIND_PAIR_STATES) buffer States { PairState states[]; };
layout(std430, binding = BIND_WAYS) writeonly buffer Ways { float ways[]; };
layout(std430, binding = BIND_FAULTS) buffer Faults { ContactFaults faults; };
layout(std430, binding = BIND_SELF_RANGES) readonly buffer SelfRanges { uvec4 self_ranges[]; };
layout(std430, binding = BIND_SELF_NEAR) buffer SelfNears { SelfNear self_near[]; };
#include "plane_team.glsl"
#include "plane_project.glsl"

void main() {
  begin_substep(p.first_substep);
  project_all(item(), stride());
  if (item() == 0u) ledger.asked[1] = ledger.self_near = ledger.self_touching = 0u;  // for the next substep
}

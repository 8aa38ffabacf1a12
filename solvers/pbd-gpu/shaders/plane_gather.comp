#version 450
// A round's end, a thread a vertex; SHUFFLES: a team of lanes.
#include "common.glsl"
#include "plane_buffers.glsl"
layout(std430, binding = BIND_POSITIONS) buffer Positions { vec4 x[]; };
layout(std430, binding = BIND_VELOCITIES) buffer Velocities { vec4 v[]; };
layout(std430, binding = BIND_PREDICTED) buffer Proposed { vec4 y[]; };
layout(std430, binding = BIND_STARTS) readonly buffer Starts { vec4 starts[]; };
layout(std430, binding = BIND_FANS) readonly buffer Fans { uint fans[]; };  // first entry a vertex; 4 triangle + corner
layout(std430, binding = BIND_RANGES) readonly buffer Ranges { uvec4 ranges[]; };  // x: first pair, y: pairs
layout(std430, binding = BIND_TOUCHED) buffer Touched { uint touched[]; };
layout(std430, binding = BIND_LEDGER) readonly buffer Ledger { ContactLedger ledger; };
layout(std430, binding = BIND_NEAR_BITS) readonly buffer NearBits { uint near_bits[]; };
layout(std430, binding = BIND_PAIR_STATES) readonly buffer States { PairState states[]; };
layout(std430, binding = BIND_SELF_RANGES) readonly buffer SelfRanges { uvec4 self_ranges[]; };  // z: first near pair, w: near pairs
layout(std430, binding = BIND_SELF_NEAR) readonly buffer SelfNears { SelfNear self_near[]; };
layout(std430, binding = BIND_SELF_PUSHES) readonly buffer SelfPushes { SelfPush self_pushes[]; };
#include "plane_team.glsl"
#include "plane_gather.glsl"

void main() {
  turn = p.turn;
  gather_all(item(), stride());
}

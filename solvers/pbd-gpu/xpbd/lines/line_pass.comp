#version 450
// Solves colours of lines of a cloth of any size, with the state in memory. A substep's first colour also predicts its
// vertices. Each colour contains every vertex exactly once, so it can update the state in place. A dispatch solves one
// colour or, with PERSISTENT, any number: then all workgroups run at once and synchronise by barriers.
#define SUBGROUPS
#include "common/common.glsl"
layout(std430, binding = BIND_POSITIONS) coherent buffer Positions { vec4 x[]; };
layout(std430, binding = BIND_VELOCITIES) coherent buffer Velocities { vec4 v[]; };
layout(std430, binding = BIND_LAST_POSITIONS) buffer LastPositions { vec4 lx[]; };
layout(std430, binding = BIND_LAST_VELOCITIES) buffer LastVelocities { vec4 lv[]; };
#include "xpbd/lines/grid_lines.glsl"
#include "common/grid_barrier.glsl"
#include "xpbd/lines/line_colour.glsl"

void main() {
  set_place(gl_WorkGroupID.y * gl_NumWorkGroups.x + gl_WorkGroupID.x);
  const uint colours = kShears ? 4u : 2u;
  if (PERSISTENT && p.passes == 0u && !grid_barrier()) return;  // runs_at_once(): only tests the barrier
  for (uint n = p.first_pass; n < p.first_pass + p.passes; ++n) {
    if (PERSISTENT && n > p.first_pass && !grid_barrier()) return;
    uint turn = n % colours;
    colour = colours - 1u - turn;
    kick_scale = p.kick_scale;
    pass(n / colours, turn == 0u);
  }
  if (PERSISTENT) leave_grid_barrier();
}

#version 450
// Colours of lines of a cloth of any size, its state in memory. The first colour of a substep integrates what it loads,
// the last limits what it stores; every colour has every vertex exactly once, so in place is in order. A dispatch is
// one colour, or with PERSISTENT any number of them: then its workgroups run at once and wait for one another.
#define SUBGROUPS
#include "common/common.glsl"
layout(std430, binding = BIND_POSITIONS) coherent buffer Positions { vec4 x[]; };
layout(std430, binding = BIND_VELOCITIES) coherent buffer Velocities { vec4 v[]; };
layout(std430, binding = BIND_POSITION_COMPENSATION) coherent buffer PositionCompensation { vec4 rx[]; };
layout(std430, binding = BIND_VELOCITY_COMPENSATION) coherent buffer VelocityCompensation { vec4 rv[]; };
layout(std430, binding = BIND_LAST_POSITIONS) buffer LastPositions { vec4 lx[]; };
layout(std430, binding = BIND_LAST_VELOCITIES) buffer LastVelocities { vec4 lv[]; };
layout(std430, binding = BIND_REGULARISATION) readonly buffer Regularisation { float regularisation[]; };  // by chain
#include "xpbd/lines/grid_lines.glsl"

/// Pinned vertices are never written, so reading them here races with nothing.
vec3 anchor(uvec2 at, uint k) {
  return x[index_of(at)].xyz;
}
#include "xpbd/lines/integrate_lines.glsl"
#include "common/grid_barrier.glsl"

#include "xpbd/lines/line_colour.glsl"

void main() {
  set_thread();
  lane = thread / BESIDE % LANES;
  chain = (gl_WorkGroupID.y * gl_NumWorkGroups.x + gl_WorkGroupID.x) * (THREADS / LANES) +
          thread / (LANES * BESIDE) * BESIDE + thread % BESIDE;
  [[unroll]] for (uint k = 0u; k < K; ++k) rest_pos[k] = rest_vel[k] = last_pos[k] = last_vel[k] = vec3(0.0);
  const uint colours = kShears ? 4u : 2u;
  if (PERSISTENT && p.passes == 0u && !grid_barrier()) return;  // only a probe whether all can run
  for (uint n = p.first_pass; n < p.first_pass + p.passes; ++n) {
    if (PERSISTENT && n > p.first_pass && !grid_barrier()) return;
    uint turn = n % colours;
    colour = colours - 1u - turn;
    pass(n / colours, turn == 0u, turn + 1u == colours);
  }
  if (PERSISTENT) leave_grid_barrier();
}

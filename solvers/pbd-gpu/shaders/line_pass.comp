#version 450
// One family of lines of a cloth of any size, its state in memory. The first family of a substep integrates what it loads,
// the last limits what it stores; every family has every vertex exactly once, so in place is in order.
#ifdef KEEP_MULTIPLIERS
#define COUNTER_BINDING 7
#else
#define COUNTER_BINDING 5
#endif
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_control_flow_attributes : require
#ifdef SHUFFLES
#extension GL_KHR_shader_subgroup_basic : require
#extension GL_KHR_shader_subgroup_shuffle : require
#endif
#include "common.glsl"
layout(std430, binding = 0) buffer Positions { vec4 x[]; };
layout(std430, binding = 1) buffer Velocities { vec4 v[]; };
layout(std430, binding = 2) buffer PositionRests { vec4 rx[]; };
layout(std430, binding = 3) buffer VelocityRests { vec4 rv[]; };
layout(std430, binding = 4) readonly buffer Firmness { float firmness[]; };  // a number a chain, families in turn
#ifdef KEEP_MULTIPLIERS
layout(std430, binding = 5) buffer LinkMultipliers { float link_multipliers[]; };
layout(std430, binding = 6) buffer HingeMultipliers { vec4 hinge_multipliers[]; };
#endif
#include "lines.glsl"

/// Pinned vertices are never written, so reading them here races with nothing.
vec3 anchor(uvec2 at) { return LOAD16(x, index_of(at)).xyz; }
#include "lines_integrate.glsl"

void main() {
  set_thread();
  lane = thread % LANES;
  chain = (gl_WorkGroupID.y * gl_NumWorkGroups.x + gl_WorkGroupID.x) * (THREADS / LANES) + thread / LANES;
  family = p.family;
  iteration = p.iteration;
  bool first = (p.turn & LINES_FIRST) != 0u;
  [[unroll]] for (uint k = 0u; k < K; ++k) {
    uint i = lane * K + k;
    pos[k] = vel[k] = rest_pos[k] = rest_vel[k] = vec3(0.0);
    w[k] = 0.0;
    if (!on_chain(i)) continue;
    uint o = index_of(vertex(i));
    vec4 at = LOAD16(x, o);
    pos[k] = at.xyz;
    w[k] = at.w;
    if (w[k] == 0.0) continue;
    vel[k] = LOAD16(v, o).xyz;
    if (!first) continue;
    rest_pos[k] = LOAD16(rx, o).xyz;
    rest_vel[k] = LOAD16(rv, o).xyz;
  }
  if (first) integrate();
  if (kBends && family < 2u) bend();
  float least = 0.0;
  if ((FEATURES & LINES_FIRM) != 0u && chain < chain_count())
    least = LOAD4(firmness, family * max(COLUMNS, ROWS) + chain);
  stretch(least);
  if ((p.turn & LINES_LAST) != 0u) limit_speed();
  [[unroll]] for (uint k = 0u; k < K; ++k) {
    if (w[k] == 0.0) continue;
    uint o = index_of(vertex(lane * K + k));
    STORE16(x, o, vec4(pos[k], w[k]));
    STORE16(v, o, vec4(vel[k], 0.0));
    if (!first) continue;
    STORE16(rx, o, vec4(rest_pos[k], 0.0));
    STORE16(rv, o, vec4(rest_vel[k], 0.0));
  }
}

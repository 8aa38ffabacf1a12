// Solves one colour of lines with the state in memory: x, v, lx, lv and the buffers below. A fused frame uses no BDF2,
// hence neither lx nor lv. Compensation terms belong to the chains of the first colour, so a thread that keeps its
// chain keeps them in registers from substep to substep.
layout(std430, binding = BIND_POSITION_COMPENSATION) coherent buffer PositionCompensation { vec4 rx[]; };
layout(std430, binding = BIND_VELOCITY_COMPENSATION) coherent buffer VelocityCompensation { vec4 rv[]; };

/// Pinned vertices are never written, so this read cannot race with a write.
vec3 anchor(uvec2 at, uint k) {
  return x[index_of(at)].xyz;
}
#include "xpbd/lines/integrate_lines.glsl"

/// Sets this thread's index in its workgroup and on its chain, and the chain's index.
void set_place(uint group) {
  set_thread();
  lane = thread / BESIDE % LANES;
  chain = group * (THREADS / LANES) + thread / (LANES * BESIDE) * BESIDE + thread % BESIDE;
  [[unroll]] for (uint k = 0u; k < K; ++k) rest_pos[k] = rest_vel[k] = last_pos[k] = last_vel[k] = vec3(0.0);
}

void store_history(uint at[K]) {
  [[unroll]] for (uint k = 0u; k < K; ++k) {
    if (w[k] == 0.0) continue;
    rx[at[k]] = vec4(rest_pos[k], 0.0);
    rv[at[k]] = vec4(rest_vel[k], 0.0);
#ifndef FUSED_FRAME
    if (!kUsesBdf2) continue;
    lx[at[k]] = vec4(last_pos[k], 0.0);
    lv[at[k]] = vec4(last_vel[k], 0.0);
#endif
  }
}

void pass(uint substep, bool first) {
  uint at[K];
  bool fetches = first && substep == 0u;
  [[unroll]] for (uint k = 0u; k < K; ++k) {
    uint i = lane * K + k;
    pos[k] = vel[k] = vec3(0.0);
    if (kCorrectsSplitting) shift[k] = vec4(0.0);
    w[k] = 0.0;
    at[k] = 0u;
    if (!(EXACT || on_chain(i))) continue;
    at[k] = index_of(vertex(i));
    vec4 here = x[at[k]];
    pos[k] = here.xyz;
    w[k] = here.w;
    vel[k] = v[at[k]].xyz;
    if (kCorrectsSplitting) {
      vec4 by_lines = shifts[at[k]];
      if (w[k] > 0.0) shift[k] = p.h * p.h * by_lines;
    }
    if (fetches) {
      rest_pos[k] = rx[at[k]].xyz;
      rest_vel[k] = rv[at[k]].xyz;
#ifndef FUSED_FRAME
      if (kUsesBdf2) {
        last_pos[k] = lx[at[k]].xyz;
        last_vel[k] = lv[at[k]].xyz;
      }
#endif
    }
  }
  if (first) {
    integrate();
    if (substep + 1u >= p.substeps) store_history(at);
  }
  if (kBends && colour < 2u) bend();
  stretch();
  [[unroll]] for (uint k = 0u; k < K; ++k) {
    if (w[k] == 0.0) continue;
    x[at[k]] = vec4(pos[k], w[k]);
    v[at[k]] = vec4(vel[k], 0.0);
    if (kCorrectsSplitting && colour < 2u) shifts[at[k]] = p.per_h * p.per_h * shift[k];
  }
}

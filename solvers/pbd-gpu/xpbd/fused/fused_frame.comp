#version 450
// Simulates one frame in a single dispatch (xpbd/fused/README.md). Calls the functions of the path that has one kernel
// per pass. Grid barriers per substep: 8, with kinematic shapes 10. The variant CONTACT_FREE is dispatched
// first. It runs the broad phase; if the cloth is slow and no collider is within its motion bound, it simulates the
// frame with constraints only and sets frame_state.contact_free, so that the kernel with contact exits.
#define SUBGROUPS
#include "common/common.glsl"
#define FUSED_FRAME
#include "xpbd/lines/grid_lines.glsl"
#include "xpbd/contact/contact_buffers.glsl"
#include "xpbd/lines/line_colour.glsl"
#include "common/grip.glsl"
// Chains and self-contact use one kernel per pass instead.
const bool SECOND_SOLVE = false;
const uint SELF = 0u, THICKNESS_BITS = 0u;
#include "xpbd/contact/displacement_filter/contact_vertex_step.glsl"
// Whether a substep's end predicts the next substep. Not with attached vertices, which move in between.
const bool kPredictsNextSubstep = HAS_KINEMATIC != 0u && GRIPS == 0u;
#include "xpbd/contact/displacement_filter/contact_motion_bounds.glsl"
#include "xpbd/contact/subgroup_cluster.glsl"
#include "xpbd/contact/broad_phase/contact_broad_phase.glsl"
#ifdef CONTACT_FREE
#include "xpbd/contact/displacement_filter/max_displacement.glsl"
#else
#include "xpbd/contact/narrow_phase/contact_distance.glsl"
#include "xpbd/contact/response/contact_correction.glsl"
#include "xpbd/contact/narrow_phase/contact_nearest_points.glsl"
#include "xpbd/contact/response/contact_accumulate.glsl"
#include "xpbd/contact/displacement_filter/contact_select_plane.glsl"
#include "xpbd/contact/displacement_filter/contact_project.glsl"
#endif

#include "common/grid_barrier.glsl"
#define GRID_BARRIER_OR_FAIL if (!grid_barrier()) return false
#define CLOTH_LOW frame_state.cloth_low
#define CLOTH_HIGH frame_state.cloth_high
#include "xpbd/contact/broad_phase/cloth_aabb.glsl"
#ifndef CONTACT_FREE
#include "xpbd/contact/narrow_phase/contact_active_pairs.glsl"
#include "xpbd/contact/narrow_phase/contact_find_pairs.glsl"
#endif

uint global_thread, grid_stride;  // this thread among the threads of all workgroups
#define FOR_EACH_STRIDED(i, count) for (uint i = global_thread; i < (count); i += grid_stride)

#include "xpbd/fused/fused_broad_phase.glsl"
#ifndef CONTACT_FREE

// Loop over all active pairs, one thread or one subgroup per pair.
#define FOR_EACH_ACTIVE_PAIR(n, count) \
  by_subgroup = kPairsOfSubgroups; \
  for (uint n = by_subgroup ? global_thread / THREADS * gl_NumSubgroups + gl_SubgroupID : global_thread, end = count; \
       n < end; \
       n += by_subgroup ? grid_stride / THREADS * gl_NumSubgroups : grid_stride)

#endif
#ifdef CONTACT_FREE
/// A contact-free substep only clamps vertices to their motion bounds of the frame.
void end_lines(uint i, vec4 at) {
  vec4 free = starts[i];
  vec3 to = any_nearby != kOutOfReach ? clamp_to(i, at.xyz, at.w, free.xyz, free.w) : clamp_to_bounds(i, at.xyz, at.w);
  if (to != at.xyz) x[i] = vec4(to, at.w);
  if (substep_now + 1u == p.substeps) record_displacement(i, to);
}
#else
void end_lines(uint i, vec4 at) { clamp_to_motion_bound(i, at); }
#endif

bool solve_lines(uint substep) {
  const uint colours = kShears ? 4u : 2u;
#ifndef CONTACT_FREE
  clear_bits(global_thread, grid_stride, true);
#endif
  for (uint n = 0u; n < colours; ++n) {
    colour = colours - 1u - n;
    pass(substep, n == 0u);
    if (n + 1u < colours) GRID_BARRIER_OR_FAIL;  // wait for this colour's writes before the next one reads them
  }
  [[unroll]] for (uint k = 0u; k < K; ++k) {
    uint i = lane * K + k;
    if (on_chain(i)) end_lines(index_of(vertex(i)), vec4(pos[k], w[k]));
  }
  kick_scale = 1.0;
  GRID_BARRIER_OR_FAIL;  // wait for vertices before pairs or the next substep read them
  return true;
}

bool move_grips(uint s) {
  if (GRIPS == 0u) return true;
  FOR_EACH_STRIDED(g, GRIPS) move_grip(g, float(s + 1u) / float(p.substeps), p.frames_per_s);
  GRID_BARRIER_OR_FAIL;  // wait for attached vertices before threads read them
  return true;
}

/// Called by one thread: stores the step length for the next frame.
void end_frame() { frame_state.last_h = p.h; }

#ifdef CONTACT_FREE
bool substep_with(uint s) {
  begin_substep(s);
  return move_grips(s) && solve_lines(s);
}

/// Builds the list of pairs, and simulates the frame if it is contact-free: a slow cloth without pairs.
bool frame() {
  bool may_be_contact_free = is_slow();
  if (!broad_phase()) return false;
  bool contact_free = may_be_contact_free && frame_state.pairs == 0u;
  if (global_thread == 0u) frame_state.contact_free = contact_free ? 1u : 0u;
  for (uint s = 0u; contact_free && s < p.substeps; ++s)
    if (!substep_with(s)) return false;
  if (contact_free && global_thread == 0u) end_frame();
  return true;
}
#else
/// Finds the active pairs and the corrections that their contacts propose.
bool narrow_phase() {
  by_subgroup = false;
  find_active_pairs(global_thread - thread, grid_stride);
  if (!kPairsOfSubgroups) return true;
  GRID_BARRIER_OR_FAIL;  // wait for all pairs before subgroups share them evenly (neighbours are active together)
  FOR_EACH_ACTIVE_PAIR(n, ACTIVE_COUNT) process_pair(pairs[n].w);
  return true;
}

/// One response round, before (round 0) or after the constraint solve.
bool respond_to_contact(out uint active_count) {
  active_count = 0u;
  if (response_round == 0u && (substep_now == 0u || !kPredictsNextSubstep)) {
    FOR_EACH_STRIDED(i, VERTICES) predict(i);
    clear_bits(global_thread, grid_stride, true);
    GRID_BARRIER_OR_FAIL;  // wait for predicted positions before pairs read them
  }
  if (response_round < 2u) {
    if (SHAPES > 0u && !narrow_phase()) return false;
    GRID_BARRIER_OR_FAIL;  // wait for the contacts' corrections before vertices read them
  }
  active_count = ACTIVE_COUNT;
  if (global_thread == 0u && active_count > 0u) frame_state.contact_possible = 1u;
  if (ROUNDS > 1u && response_round > 1u && active_count > 0u) {
    FOR_EACH_STRIDED(n, active_count) respond(pairs[n].w);
    GRID_BARRIER_OR_FAIL;  // wait for the contacts' corrections before vertices read them
  }
  if (global_thread == 0u && response_round > 0u) frame_state.active_pair_count[0] = 0u;
  if (active_count == 0u && PLANES == 0u) return true;
  accumulate_all(global_thread, grid_stride);
  GRID_BARRIER_OR_FAIL;  // wait for vertices before the next pass reads them
  return true;
}

bool substep_with(uint s) {
  begin_substep(s);
  if (!move_grips(s)) return false;
  uint active_count = 0u;
  response_round = 0u;
  if (HAS_KINEMATIC != 0u && !respond_to_contact(active_count)) return false;
  if (!solve_lines(s)) return false;
  for (response_round = 1u; response_round <= ROUNDS; ++response_round)
    if (!respond_to_contact(active_count)) return false;
  if (active_count > 0u) {
    FOR_EACH_ACTIVE_PAIR(n, active_count) select_plane(pairs[n].w);
    GRID_BARRIER_OR_FAIL;  // wait for planes before vertices are projected onto them
  }
  project_all(global_thread, grid_stride);
  clear_bits(global_thread, grid_stride, false);
  if (global_thread == 0u) frame_state.active_pair_count[1] = 0u;
  GRID_BARRIER_OR_FAIL;  // wait for the end of this substep before the next one begins
  return true;
}

/// Simulates the frame with contact. If there are two dispatches, the contact-free one has built the list.
bool frame() {
  if (p.first_pass != BROAD_PHASE_DONE && !broad_phase()) return false;
  for (uint s = 0u; s < p.substeps; ++s)
    if (!substep_with(s)) return false;
  if (global_thread == 0u) end_frame();
  return true;
}
#endif

void main() {
  uint group = gl_WorkGroupID.y * gl_NumWorkGroups.x + gl_WorkGroupID.x;
  set_place(group);
  global_thread = group * THREADS + thread;
  grid_stride = THREADS * gl_NumWorkGroups.x * gl_NumWorkGroups.y;
  if (p.passes == 0u) {  // runs_at_once(): only tests the barrier
    if (grid_barrier()) leave_grid_barrier();
    return;
  }
#ifndef CONTACT_FREE
  if (frame_state.contact_free != 0u) return;  // the contact-free dispatch has simulated the frame
#endif
  kick_scale = kick_scale_after(frame_state.last_h);
  if (!frame()) return;
  if (global_thread < 3u) {
    frame_state.cloth_low[global_thread] = kLowNone;
    frame_state.cloth_high[global_thread] = kHighNone;
  }
  leave_grid_barrier();
}

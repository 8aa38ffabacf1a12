#version 450
// The passes of contact with colliders (xpbd/contact/README.md) as kernels of their own, in the order of a frame.
// CMakeLists.txt compiles this file once for each. fused_frame.comp calls the same functions.
#define SUBGROUPS
#include "xpbd/contact/contact_buffers.glsl"

#if defined(MOTION_BOUNDS)  // once per frame, one thread per vertex
#include "xpbd/contact/displacement_filter/contact_motion_bounds.glsl"
void run() {
  uint i = item();
  if (i >= VERTICES) return;
  float max_shape_displacement = max_displacement_of_shapes();
  motion_bound_of_vertex(i, max_shape_displacement);
  if (i != 0u) return;
  frame_state.max_shape_displacement = max_shape_displacement;
  vec3 along = mean_velocity();
  for (uint c = 0u; c < 3u; ++c) frame_state.drift[c] = 0.5 * along[c];
  frame_state.bound_fraction = 1.0;  // prefix_sum may cut it
  frame_state.touched_vertices = 0u;
  frame_state.active_pair_count[0] = frame_state.active_pair_count[1] = 0u;
}

#elif defined(BROAD_PHASE)  // once per frame, one thread per primitive: counts its pairs; FILL writes them
#include "xpbd/contact/broad_phase/contact_broad_phase.glsl"
void run() {
  for (uint k = item(); k < TRIANGLES + VERTICES; k += stride()) {
    if (FILL) {
      uvec4 range = ranges[k];
      fill_pairs(k, frame_state.bound_fraction, range.x, range.y);
      continue;
    }
    uvec4 n = uvec4(pairs_at(k, 1.0), 0u, 0u, 0u);
    [[unroll]] for (uint l = 1u; l < PAIR_LEVELS; ++l)
      if (n[l - 1u] != 0u) n[l] = pairs_at(k, kFractions[l]);
    ranges[k] = n;
  }
  for (uint i = item(); FILL && i < VERTICES; i += stride()) list_touched_vertices(i);
}

#elif defined(PREDICT)  // at a substep's start, one thread per vertex
#include "xpbd/contact/displacement_filter/contact_vertex_step.glsl"
void run() {
  if (item() < VERTICES) predict(item());
  if (SHAPES > 0u) clear_active_bits(item(), stride());
}

#elif defined(CLAMP)  // after the constraint solve, one thread per vertex
#include "xpbd/contact/displacement_filter/contact_vertex_step.glsl"
void run() {
  uint i = item();
  if (i < VERTICES) clamp_to_motion_bound(i, x[i]);
  if (i == 0u && response_round == 1u && p.first_substep == 0u) frame_state.max_displacement = 0u;  // of the last frame
  if (SHAPES > 0u && (!SECOND_SOLVE || response_round < 2u)) clear_active_bits(i, stride());
}

#elif defined(ACTIVE_PAIRS)  // once per substep and twice with kinematic shapes, one thread per candidate pair
#include "xpbd/contact/narrow_phase/contact_distance.glsl"
#include "xpbd/contact/narrow_phase/contact_active_pairs.glsl"
void run() {
  if (item() == 0u && response_round > 0u) frame_state.active_pair_count[0] = 0u;
  for (uint k = item(); k < frame_state.pairs; k += stride())
    if (may_be_active(k) && is_active(k)) append_active(k, atomicAdd(ACTIVE_COUNT, 1u));
}

#elif defined(NEAREST_POINTS)  // as often, one thread per active pair
#include "xpbd/contact/narrow_phase/contact_distance.glsl"
#include "xpbd/contact/response/contact_correction.glsl"
#include "xpbd/contact/narrow_phase/contact_nearest_points.glsl"
void run() {
  for (uint n = item(); n < ACTIVE_COUNT; n += stride()) process_pair(pairs[n].w);
}

#elif defined(ACCUMULATE)  // at the end of a round of response, a cluster of lanes per vertex
#include "xpbd/contact/subgroup_cluster.glsl"
#include "xpbd/contact/response/friction.glsl"
#include "xpbd/contact/response/contact_accumulate.glsl"
void run() { accumulate_all(item(), stride()); }

#elif defined(RESPOND)  // a later round of response, one thread per active pair
ConvexShape shape;
#include "xpbd/contact/response/contact_correction.glsl"
void run() {
  for (uint n = item(); n < frame_state.active_pair_count[1]; n += stride()) respond(pairs[n].w);
}

#elif defined(SELECT_PLANE)  // before the projection, one thread per active pair
#include "xpbd/contact/narrow_phase/contact_distance.glsl"
#include "xpbd/contact/displacement_filter/contact_select_plane.glsl"
void run() {
  for (uint n = item(); n < frame_state.active_pair_count[1]; n += stride()) select_plane(pairs[n].w);
}

#elif defined(PROJECT)  // at a substep's end, a cluster of lanes per vertex
#include "xpbd/contact/subgroup_cluster.glsl"
#include "xpbd/contact/displacement_filter/contact_project.glsl"
void run() {
  project_all(item(), stride());
  // For the next substep.
  if (item() == 0u) frame_state.active_pair_count[1] = frame_state.self_active = frame_state.self_contact_pairs = 0u;
}
#endif

void main() {
  response_round = p.response_round;
  begin_substep(p.first_substep);
  run();
}

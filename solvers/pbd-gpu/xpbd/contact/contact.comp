#version 450
// The contact passes (xpbd/contact/README.md), one kernel each, in the order of a frame. CMakeLists.txt compiles this
// file once per pass, with the pass's macro defined. fused_frame.comp calls the same functions.
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
  frame_state.touched_vertices = 0u;
  for (uint l = 0u; l < PAIR_LEVELS; ++l) frame_state.counted[l] = 0u;
  frame_state.self_list_expired = 1u;
  frame_state.active_pair_count[0] = frame_state.active_pair_count[1] = 0u;
}

#elif defined(BROAD_PHASE)  // once per frame for each of kFractions, one thread per primitive
#include "xpbd/contact/broad_phase/contact_broad_phase.glsl"
void run() {
  if (p.level > 0u && frame_state.counted[p.level - 1u] <= CAPACITY) return;
  for (uint k = item(); k < TRIANGLES + VERTICES; k += stride()) {
    uint n = pairs_at(k, kFractions[p.level]), at = min(atomicAdd(frame_state.counted[p.level], n), CAPACITY);
    uint room = min(n, CAPACITY - at);
    ranges[k] = uvec4(at, room, 0u, 0u);
    fill_pairs(k, kFractions[p.level], at, room);
  }
}

#elif defined(FINISH_BROAD_PHASE)  // once per frame, one thread per vertex
#include "xpbd/contact/broad_phase/contact_broad_phase.glsl"
void run() {
  uint i = item();
  if (SHAPES > 0u && i < VERTICES) list_touched_vertices(i);
  if (i != 0u) return;
  finish_broad_phase();
}

#elif defined(PREDICT)  // at a substep's start, one thread per vertex
#include "xpbd/contact/displacement_filter/contact_vertex_step.glsl"
void run() {
  if (item() < VERTICES) predict(item());
  if (SHAPES > 0u) clear_bits(item(), stride(), true);
}

#elif defined(CLAMP)  // after the constraint solve, one thread per vertex
#include "xpbd/contact/displacement_filter/contact_vertex_step.glsl"
void run() {
  uint i = item();
  if (i < VERTICES) clamp_to_motion_bound(i, x[i]);
  if (i == 0u && response_round == 1u && p.first_substep == 0u) frame_state.max_displacement = 0u;  // for this frame
  if (SHAPES > 0u && (!SECOND_SOLVE || response_round < 2u)) clear_bits(i, stride(), true);
}

#elif defined(FIND_PAIRS)  // once per substep, twice with kinematic shapes; one thread per candidate pair
#include "xpbd/contact/narrow_phase/contact_distance.glsl"
#include "xpbd/contact/response/contact_correction.glsl"
#include "xpbd/contact/narrow_phase/contact_nearest_points.glsl"
#include "xpbd/contact/narrow_phase/contact_active_pairs.glsl"
#include "xpbd/contact/narrow_phase/contact_find_pairs.glsl"
void run() {
  if (item() == 0u && response_round > 0u) frame_state.active_pair_count[0] = 0u;
  find_active_pairs(item() - gl_LocalInvocationIndex, stride());
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
  if (item() != 0u) return;  // for the next substep
  frame_state.active_pair_count[1] = frame_state.self_active = 0u;
  frame_state.self_contact_pairs = frame_state.self_contacts = 0u;
}

#elif defined(MEASURE)  // at a list's end, one thread per link: what sets the next frame's substeps
#include "xpbd/contact/subgroup_cluster.glsl"
void run() {
  float strain = 0.0;
  for (uint k = item(); k < links.length(); k += stride())
    strain = max(strain, distance(x[links[k].a].xyz, x[links[k].b].xyz) / links[k].rest_m - 1.0);
  uint bits = floatBitsToUint(subgroup_max(strain));
  if (gl_SubgroupInvocationID == 0u && bits > frame_state.max_strain) atomicMax(frame_state.max_strain, bits);
  memoryBarrierBuffer();
  barrier();  // wait for the workgroup's strain before the last workgroup reads the maximum
  if (gl_LocalInvocationIndex != 0u) return;
  if (atomicAdd(frame_state.measured, 1u) + 1u < gl_NumWorkGroups.x * gl_NumWorkGroups.y) return;
  diagnostics.max_strain = max(diagnostics.max_strain, atomicExchange(frame_state.max_strain, 0u));
  diagnostics.max_displacement = max(diagnostics.max_displacement, frame_state.max_displacement);
  frame_state.measured = 0u;
}

// Self-contact.
#elif defined(SELF_AABBS)  // once per substep, one thread per triangle
#include "xpbd/contact/broad_phase/self_aabbs.glsl"
void run() {
  if (frame_state.self_list_expired != 0u) make_self_aabbs();
}

#elif defined(SELF_BROAD_PHASE)  // twice per substep, one subgroup per triangle
#include "xpbd/contact/broad_phase/self_broad_phase.glsl"
void run() {
  if (frame_state.self_list_expired == 0u || (p.level > 0u && frame_state.self_listed[0] <= SELF_CAPACITY)) return;
  FOR_EACH_TRIANGLE(q, TRIANGLES, list_self_pairs_of(q);)
}

#elif defined(SELF_MAX_DISPLACEMENT)  // once per substep, one thread per triangle
// Per triangle: maximum displacement of its vertices in the last substep, and their largest limit in this one. A new
// list's bounds hold for this substep's start.
void run() {
  bool is_new = frame_state.self_list_expired != 0u;
  if (is_new && item() == 0u) {
    uint level = frame_state.self_listed[0] <= SELF_CAPACITY ? 0u : 1u, listed = frame_state.self_listed[level];
    frame_state.self_list_one_substep = level;
    if (listed > SELF_CAPACITY) diagnostics.overflow += listed - SELF_CAPACITY;
  }
  for (uint t = item(); t < TRIANGLES; t += stride()) {
    uvec4 e = primitives[t];
    vec2 largest = vec2(0.0);
    for (uint c = 0u; c < 3u; ++c) largest = max(largest, vec2(vertex_displacement[e[c]], starts[e[c]].w));
    triangle_max_displacement[t] = vec4(is_new ? 0.0 : largest.x, largest.y, 0.0, 0.0);
  }
}

#elif defined(SELF_ACTIVE_PAIRS)  // after the constraint solve, one subgroup per triangle
#include "xpbd/contact/narrow_phase/self_active_pairs.glsl"
void run() { FOR_EACH_TRIANGLE(t, TRIANGLES, collect_active_pairs(t);) }

#elif defined(SELF_NEAREST_POINTS)  // after SELF_ACTIVE_PAIRS, one thread per active pair: contacts and corrections
#include "xpbd/contact/narrow_phase/contact_distance.glsl"
#include "xpbd/contact/response/self_correction.glsl"
#include "xpbd/contact/narrow_phase/self_nearest_points.glsl"
void run() {
  for (uint k = item(); k < SELF_ACTIVE_COUNT; k += stride()) {
    query_self(k);
    correct_self(k);
  }
}

#elif defined(SELF_RESPOND)  // a later round of response, one thread per active pair
#include "xpbd/contact/response/self_correction.glsl"
void run() {
  for (uint k = item(); k < SELF_ACTIVE_COUNT; k += stride()) correct_self(k);
}

#elif defined(SELF_SELECT_PLANE)  // before the projection, one thread per active pair
#include "xpbd/contact/displacement_filter/self_select_plane.glsl"
#include "xpbd/contact/broad_phase/atomic_aabb.glsl"
void run() {
  for (uint k = item(); k < SELF_ACTIVE_COUNT; k += stride()) select_self_plane(k);
  for (uint n = item(); n < self_supergroups.length(); n += stride())
    for (uint c = 0u; c < 3u; ++c) {
      self_supergroups[n].low[c] = kLowNone;
      self_supergroups[n].high[c] = kHighNone;
    }
  if (item() != 0u) return;
  frame_state.self_list_expired = frame_state.self_list_one_substep;  // for the next substep
  frame_state.self_listed[0] = frame_state.self_listed[1] = 0u;
}
#endif

void main() {
  response_round = p.response_round;
  begin_substep(p.first_substep);
  run();
}

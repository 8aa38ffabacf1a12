#version 450
// A frame of cloth with contact by planes in one dispatch: the list of pairs, then every substep with its lines, phase for phase as
// the kernels of the phases have it. Any number of workgroups that run at once wait for one another (device_barrier.glsl).
// FAR: the list, and the frame if the cloth meets no collider. It needs the lines alone.
#define SUBGROUPS
#include "common.glsl"
#define PLANE_FRAME
layout(std430, binding = BIND_POSITION_COMPENSATION) coherent buffer PositionCompensation { vec4 rx[]; };
layout(std430, binding = BIND_VELOCITY_COMPENSATION) coherent buffer VelocityCompensation { vec4 rv[]; };
layout(std430, binding = BIND_REGULARISATION) readonly buffer Regularisation { float regularisation[]; };

PLANE_FRAME_CONSTANTS(SPECIALIZE)
#define MARGIN_M uintBitsToFloat(MARGIN_BITS)
#include "lines.glsl"
#include "plane_buffers.glsl"
vec3 anchor(uvec2 at, uint k) {
  if (w[k] > 0.0) COUNT_READ(16u)
  return x[index_of(at)].xyz;
}
#include "lines_integrate.glsl"
#include "line_family.glsl"
#include "grip.glsl"
// Chains and cloth that touches itself have a kernel a phase.
const bool AGAIN = false;
const uint SELF = 0u;
#include "plane_vertices.glsl"
// The next substep's prediction, at this one's end. What hands hold is moved between the two.
const bool kPredictsEarly = MOVING != 0u && GRIPS == 0u;
#include "plane_reach.glsl"
#include "plane_team.glsl"
#include "plane_list.glsl"
#ifdef FAR
#include "plane_way.glsl"
#else
#include "plane_geometry.glsl"
#include "plane_push.glsl"
#include "plane_query.glsl"
#include "plane_respond.glsl"
#include "plane_gather.glsl"
#include "plane_choose.glsl"
#include "plane_project.glsl"
#endif

#include "device_barrier.glsl"
#define MEET if (!grid_barrier()) return
#define MEET_OR_FAIL if (!grid_barrier()) return false
#define COUNTED(t) ledger.asked[t]
#define CLOTH_LOW ledger.cloth_low
#define CLOTH_HIGH ledger.cloth_high
// Within a workgroup, also for what its threads write to buffers.
#define GROUP_MEET { groupMemoryBarrier(); barrier(); }
#include "plane_cloth_box.glsl"
#ifndef FAR
#define NEAR_COUNT COUNTED(min(turn, 1u))
#include "plane_near.glsl"
#endif

const uint kTurns = 3u;
uint me, all_threads;  // this thread among those of all workgroups
#define EACH(i, count) for (uint i = me; i < (count); i += all_threads)

#include "plane_frame_list.glsl"
#ifndef FAR

// All near pairs, a thread or a subgroup each.
#define EACH_NEAR_PAIR(n, count)                                                                                       \
  by_subgroup = kPairsOfSubgroups;                                                                                     \
  for (uint n = by_subgroup ? me / THREADS * gl_NumSubgroups + gl_SubgroupID : me, end = count; n < end;               \
       n += by_subgroup ? all_threads / THREADS * gl_NumSubgroups : all_threads)

// A workgroup looks through its share of the pairs a few rounds at a time. Its threads share out those that remain after each question,
// so that no thread waits for its neighbour's answer.
const uint kRounds = THREADS < 512u ? 512u / THREADS : 1u;
shared uint looked_at[kRounds * THREADS], near_found[kRounds * THREADS], looked, near_ones, place;
void look_for_near() {
  uint count = ledger.pairs;  // read once, for a coherent read goes to the second-level cache
  for (uint base = me - thread; base < count; base += kRounds * all_threads) {
    if (thread == 0u) looked = near_ones = 0u;
    barrier();  // before they are counted
    for (uint r = 0u; r < kRounds; ++r) {
      uint k = base + r * all_threads + thread;
      if (k < count && may_be_near(k)) looked_at[atomicAdd(looked, 1u)] = k;
    }
    GROUP_MEET;  // all that may be near are known, and their bounds
    for (uint n = thread; n < looked; n += THREADS)
      if (is_near(looked_at[n])) near_found[atomicAdd(near_ones, 1u)] = looked_at[n];
    GROUP_MEET;  // all that are near are known, and their normals
    if (thread == 0u && near_ones > 0u) place = atomicAdd(NEAR_COUNT, near_ones);
    barrier();  // where they are listed
    for (uint n = thread; n < near_ones; n += THREADS) {
      list_near(near_found[n], place + n);
      if (!kPairsOfSubgroups) ask(near_found[n]);
    }
    barrier();  // before the next rounds
  }
}

#endif
// Where one workgroup holds all lines, families wait for their own workgroup alone.
bool lines_in_a_group() { return THREADS / LANES >= COLUMNS && THREADS / LANES >= ROWS; }

#ifdef FAR
/// All that is left of contact in a substep: how far a vertex may go in the frame.
void end_lines(uint i, vec4 at) {
  vec4 free = LOAD16(starts, i);
  vec3 to = any_near != kFar ? within_most(i, at.xyz, at.w, free.xyz, free.w) : within_reach(i, at.xyz, at.w);
  if (to != at.xyz) STORE16(x, i, vec4(to, at.w));
  if (substep_now + 1u == p.substeps) note_way(i, to);
}
#else
void end_lines(uint i, vec4 at) { settle(i, at); }
#endif

bool solve_lines(uint substep) {
  const uint families = kShears ? 4u : 2u;
#ifndef FAR
  forget_near(me, all_threads);
#endif
  for (uint n = 0u; n < families && (!lines_in_a_group() || me == thread); ++n) {
    family = families - 1u - n;
    pass(substep, n == 0u, n + 1u == families);
    if (n + 1u == families) break;
    if (lines_in_a_group()) GROUP_MEET
    else MEET_OR_FAIL;  // this family's writes before the next one's reads
  }
  [[unroll]] for (uint k = 0u; k < K; ++k) {
    uint i = lane * K + k;
    if ((!lines_in_a_group() || me == thread) && on_chain(i)) end_lines(index_of(vertex(i)), vec4(pos[k], w[k]));
  }
  MEET_OR_FAIL;  // proposals before pairs read them, or vertices before the next substep
  return true;
}

bool move_grips(uint s) {
  if (GRIPS == 0u) return true;
  EACH(g, GRIPS) move_grip(g, float(s + 1u) / float(p.substeps), p.frames_per_s);
  MEET_OR_FAIL;  // held vertices before all read them
  return true;
}

/// By one thread: what the host goes by.
void end_frame() { faults.farthest = ledger.farthest; }

#ifdef FAR
bool substep_with(uint s) {
  begin_substep(s);
  return move_grips(s) && solve_lines(s);
}

/// The list, and the whole frame if the cloth meets no collider.
bool frame() {
  bool may_be_far = is_slow();
  if (!list_pairs()) return false;
  bool far = may_be_far && ledger.pairs == 0u;
  if (me == 0u) ledger.far = far ? 1u : 0u;
  for (uint s = 0u; far && s < p.substeps; ++s)
    if (!substep_with(s)) return false;
  if (far && me == 0u) end_frame();
  return true;
}
#else
/// Pairs that are near, and what their contacts propose.
bool ask_near() {
  by_subgroup = false;
  look_for_near();
  if (!kPairsOfSubgroups) return true;
  MEET_OR_FAIL;  // near pairs before they are shared out: neighbours in the list are near together
  EACH_NEAR_PAIR(n, COUNTED(min(turn, 1u))) ask(pairs[n].w);
  return true;
}


/// Responses before (turn 0) and after the lines.
bool respond_to_contact(out uint near) {
  near = 0u;
  if (turn == 0u && (substep_now == 0u || !kPredictsEarly)) {
    EACH(i, VERTICES) predict(i);
    forget_near(me, all_threads);
    MEET_OR_FAIL;  // proposals before pairs read them
  }
  if (turn < 2u) {
    if (PIECES > 0u && !ask_near()) return false;
    MEET_OR_FAIL;  // what contacts propose before vertices take it
  }
  near = COUNTED(min(turn, 1u));
  if (me == 0u && near > 0u) ledger.meets = 1u;
  if (turn == 2u && near > 0u) {
    EACH(n, near) respond(pairs[n].w);
    MEET_OR_FAIL;  // as above
  }
  if (me == 0u && turn > 0u) COUNTED(0u) = 0u;
  if (near == 0u && PLANES == 0u) return true;
  gather_all(me, all_threads);
  MEET_OR_FAIL;  // vertices before what reads them
  return true;
}

bool substep_with(uint s) {
  begin_substep(s);
  if (!move_grips(s)) return false;
  uint near = 0u;
  turn = 0u;
  if (MOVING != 0u && !respond_to_contact(near)) return false;
  if (!solve_lines(s)) return false;
  for (turn = 1u; turn < kTurns; ++turn)
    if (!respond_to_contact(near)) return false;
  if (near > 0u) {
    EACH_NEAR_PAIR(n, near) choose(pairs[n].w);
    MEET_OR_FAIL;  // planes before vertices are put before them
  }
  project_all(me, all_threads);
  forget_pushes(me, all_threads);
  if (me == 0u) COUNTED(1u) = 0u;
  MEET_OR_FAIL;  // the substep's end before the next one
  return true;
}

/// The frame, unless it is done without contact. In two dispatches the first has made the list.
bool frame() {
  if (p.first_pass != PLANE_FRAME_LISTED && !list_pairs()) return false;
  for (uint s = 0u; s < p.substeps; ++s)
    if (!substep_with(s)) return false;
  if (me == 0u) end_frame();
  return true;
}
#endif

void main() {
  set_thread();
  lane = thread / BESIDE % LANES;
  uint group = gl_WorkGroupID.y * gl_NumWorkGroups.x + gl_WorkGroupID.x;
  chain = group * (THREADS / LANES) + thread / (LANES * BESIDE) * BESIDE + thread % BESIDE;
  me = group * THREADS + thread;
  all_threads = THREADS * gl_NumWorkGroups.x * gl_NumWorkGroups.y;
  [[unroll]] for (uint k = 0u; k < K; ++k) rest_pos[k] = rest_vel[k] = last_pos[k] = last_vel[k] = vec3(0.0);
  if (p.passes == 0u) {  // asked only whether all can
    MEET;
    leave_grid_barrier();
    return;
  }
#ifndef FAR
  if (ledger.far != 0u) return;  // the frame is done
#endif
  if (!frame()) return;
  if (me < 3u) {
    ledger.cloth_low[me] = kLowNone;
    ledger.cloth_high[me] = kHighNone;
  }
  leave_grid_barrier();
}

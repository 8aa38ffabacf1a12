#version 450
// A frame of cloth with contact by planes in one dispatch: the list of pairs, then every substep with its lines, phase for phase as
// the kernels of the phases have it and with the same bits. One workgroup takes a cloth of at most 32 x 32 vertices; with
// MANY_GROUPS any number of workgroups that run at once wait for one another (device_barrier.glsl).
#include "common.glsl"
#define PLANE_FRAME
#ifdef MANY_GROUPS
#define STATE coherent
#else
// One workgroup is on one multiprocessor: what its threads write before memoryBarrierBuffer() and barrier() they all see.
#define STATE
#endif
layout(std430, binding = BIND_POSITIONS) STATE buffer Positions { vec4 x[]; };  // w: inverse mass in the lines
layout(std430, binding = BIND_VELOCITIES) STATE buffer Velocities { vec4 v[]; };
layout(std430, binding = BIND_POSITION_COMPENSATION) STATE buffer PositionCompensation { vec4 rx[]; };
layout(std430, binding = BIND_VELOCITY_COMPENSATION) STATE buffer VelocityCompensation { vec4 rv[]; };
layout(std430, binding = BIND_REGULARISATION) readonly buffer Regularisation { float regularisation[]; };
layout(std430, binding = BIND_GRIPS) readonly buffer Grips { GripVertex grips[]; };
layout(std430, binding = BIND_PREDICTED) STATE buffer Proposed { vec4 y[]; };  // w: inverse mass
layout(std430, binding = BIND_STARTS) STATE buffer Starts { vec4 starts[]; };  // at the substep's start; w: farthest it may go
layout(std430, binding = BIND_REACHES) STATE buffer Reaches { vec4 reaches[]; };
layout(std430, binding = BIND_WAYS) STATE buffer Ways { float ways[]; };
layout(std430, binding = BIND_FANS) readonly buffer Fans { uint fans[]; };
layout(std430, binding = BIND_NEAR_BITS) STATE buffer NearBits { uint near_bits[]; };
layout(std430, binding = BIND_TOUCHED) STATE buffer Touched { uint touched[]; };
layout(std430, binding = BIND_RANGES) STATE buffer Ranges { uvec4 ranges[]; };
layout(std430, binding = BIND_PAIRS) STATE buffer Pairs { uvec4 pairs[]; };  // of the first of them, w: pairs that are asked
layout(std430, binding = BIND_PAIR_STATES) STATE buffer States { PairState states[]; };
layout(std430, binding = BIND_LEDGER) STATE buffer Ledger { ContactLedger ledger; };
layout(std430, binding = BIND_FAULTS) STATE buffer Faults { ContactFaults faults; };
layout(std430, binding = BIND_SELF_RANGES) readonly buffer SelfRanges { uvec4 self_ranges[]; };
layout(std430, binding = BIND_SELF_NEAR) STATE buffer SelfNears { SelfNear self_near[]; };
layout(std430, binding = BIND_SELF_PUSHES) readonly buffer SelfPushes { SelfPush self_pushes[]; };

PLANE_FRAME_CONSTANTS(SPECIALIZE)
#define MARGIN_M uintBitsToFloat(MARGIN_BITS)
#include "lines.glsl"
vec3 anchor(uvec2 at, uint k) {
  if (w[k] > 0.0) COUNT_READ(16u)
  return x[index_of(at)].xyz;
}
#include "lines_integrate.glsl"
#include "line_family.glsl"
#include "grip.glsl"
#include "plane_buffers.glsl"
const bool AGAIN = false;  // of chains alone
#include "plane_vertices.glsl"
// The next substep's prediction, at this one's end. What hands hold is moved between the two.
const bool kPredictsEarly = MOVING != 0u && GRIPS == 0u;
#include "plane_reach.glsl"
#include "plane_list.glsl"
#include "plane_geometry.glsl"
#include "plane_push.glsl"
#include "plane_query.glsl"
#include "plane_team.glsl"
#include "plane_respond.glsl"
#include "plane_gather.glsl"
#include "plane_choose.glsl"
#include "plane_project.glsl"

#ifdef MANY_GROUPS
#include "device_barrier.glsl"
#define MEET if (!grid_barrier()) return
#define MEET_OR_FAIL if (!grid_barrier()) return false
#define COUNTED(t) ledger.asked[t]
#define CLOTH_LOW ledger.cloth_low
#define CLOTH_HIGH ledger.cloth_high
#else
#define MEET { groupMemoryBarrier(); barrier(); }
#define MEET_OR_FAIL MEET
shared uint asked[2];
#define COUNTED(t) asked[t]
#define CLOTH_LOW cloth_low
#define CLOTH_HIGH cloth_high
#endif
// Within a workgroup, also for what its threads write to buffers.
#define GROUP_MEET { groupMemoryBarrier(); barrier(); }
shared uint any_near;
#include "plane_cloth_box.glsl"
#define NEAR_COUNT COUNTED(min(turn, 1u))
#include "plane_near.glsl"

const uint kTurns = 3u;
uint me, all_threads;  // this thread among those of all workgroups
#define EACH(i, count) for (uint i = me; i < (count); i += all_threads)

/// Reaches of all vertices, and the box of everywhere that the cloth may go in the frame.
void reach_and_widen(float carried) {
  uvec3 from = uvec3(kLowNone), to = uvec3(kHighNone);
  EACH(i, VERTICES) widen(from, to, reach_of_vertex(i, carried));
  widen_box(from, to);
#ifdef MANY_GROUPS
  barrier();  // the workgroup's box before that of all
  if (thread < 3u) {
    atomicMin(ledger.cloth_low[thread], cloth_low[thread]);
    atomicMax(ledger.cloth_high[thread], cloth_high[thread]);
  }
#endif
}

shared uint listed, first_listed;  // of the workgroup
const uint kKept = 16u;
/// Lists the pairs of all elements at a share of the reaches. Elements have their places in no fixed order; the order within an element's
/// is that of pieces. What the list has no place for is counted alone.
void list_at(float share, uint level) {
  for (uint base = me - thread; base < TRIANGLES + VERTICES; base += all_threads) {
    uint k = base + thread, n = 0u, kept[kKept];
    if (thread == 0u) listed = 0u;
    if (k < TRIANGLES + VERTICES) {
      box_for(LOAD16(elements, k), share);
      EACH_PIECES_MET(
        for (; met != 0u; met &= met - 1u) {
          if (n < kKept) kept[n] = q + uint(findLSB(met));
          ++n;
        }
      )
    }
    barrier();  // before places in the workgroup's part are given
    uint at = n > 0u ? atomicAdd(listed, n) : 0u;
    barrier();  // all places of the workgroup before its part is taken
    if (thread == 0u && listed > 0u) first_listed = atomicAdd(ledger.counted[level], listed);
    barrier();  // the part's beginning before it is filled
    if (k >= TRIANGLES + VERTICES) continue;
    at = min(first_listed + at, CAPACITY);
    uint room = min(n, CAPACITY - at);
    STORE16(ranges, k, uvec4(n > 0u ? at : 0u, room, 0u, 0u));
    if (n > kKept)
      fill_pairs(k, share, at, room);
    else
      for (uint m = 0u; m < room; ++m) write_pair(at + m, k, kept[m]);
  }
}

void note_list(uint level) {
  uint all = ledger.counted[level];
  ledger.pairs = min(all, CAPACITY);
  ledger.reach = 1.0 / float(1u << CUT_BITS * level);
  if (all > CAPACITY) faults.dropped += all - CAPACITY;
}

/// The frame's list of pairs. Where no piece comes near the cloth there is none, and it costs a look at the groups' boxes.
bool list_pairs() {
  if (thread == 0u) any_near = 0u;
  for (uint word = thread; word < GROUP_WORDS; word += THREADS) near_groups[word] = 0u;
  empty_box();
#ifndef MANY_GROUPS
  if (thread < 2u) COUNTED(thread) = 0u;
#endif
  float carried = greatest_displacement();
  if (me == 0u) {
    ledger.carried = carried;
    ledger.reach = 1.0;
    ledger.pairs = ledger.touched_vertices = 0u;
    for (uint l = 0u; l < PAIR_LEVELS; ++l) ledger.counted[l] = 0u;
  }
  MEET_OR_FAIL;  // empty boxes before they are widened
  reach_and_widen(carried);
  MEET_OR_FAIL;  // reaches before the list
  for (uint g = thread; g < GROUPS; g += THREADS)
    if (meets_cloth(LOAD(32u, boxes, PIECES + g))) {
      uint bit = g / GROUPS_A_BIT;
      atomicOr(near_groups[bit / 32u], 1u << bit % 32u);
      any_near = 1u;
    }
  barrier();  // every thread's look before the answer
  if (any_near == 0u) return true;
  uint level = 0u;
  for (;; ++level) {
    list_at(1.0 / float(1u << CUT_BITS * level), level);
    MEET_OR_FAIL;  // pairs before they are read, and their number
    if (level + 1u == PAIR_LEVELS || ledger.counted[level] <= CAPACITY) break;
  }
  if (me == 0u) note_list(level);
  EACH(i, VERTICES) list_touched(i);
  MEET_OR_FAIL;  // the list before it is read
  return true;
}

// A workgroup looks through its share of the pairs a few rounds at a time. Its threads share out those that remain after each question,
// so that no thread waits for its neighbour's answer.
const uint kRounds = THREADS < 512u ? 512u / THREADS : 1u;
shared uint looked_at[kRounds * THREADS], found[kRounds * THREADS], looked, near_ones, place;
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
      if (is_near(looked_at[n])) found[atomicAdd(near_ones, 1u)] = looked_at[n];
    GROUP_MEET;  // all that are near are known, and their normals
    if (thread == 0u && near_ones > 0u) place = atomicAdd(NEAR_COUNT, near_ones);
    barrier();  // where they are listed
    for (uint n = thread; n < near_ones; n += THREADS) {
      list_near(found[n], place + n);
      ask(found[n]);
    }
    barrier();  // before the next rounds
  }
}

// Where one workgroup holds all lines, families wait for their own workgroup alone.
bool lines_in_a_group() { return THREADS / LANES >= COLUMNS && THREADS / LANES >= ROWS; }

/// `touches`: the last family's vertices are settled.
bool solve_lines(uint substep, bool touches) {
  const uint families = kShears ? 4u : 2u;
  uint passes = families * p.iterations;
  if (touches) forget_near(me, all_threads);
  for (uint n = 0u; n < passes && (!lines_in_a_group() || me == thread); ++n) {
    uint which = n % families;
    family = families - 1u - which;
    iteration = n / families;
    pass(substep, which == 0u && iteration == 0u, which + 1u == families && iteration + 1u == p.iterations);
    if (n + 1u == passes) break;
    if (lines_in_a_group()) GROUP_MEET
    else MEET_OR_FAIL;  // this family's writes before the next one's reads
  }
  [[unroll]] for (uint k = 0u; k < K; ++k) {
    uint i = lane * K + k;
    if (touches && (!lines_in_a_group() || me == thread) && on_chain(i)) settle(index_of(vertex(i)), vec4(pos[k], w[k]));
  }
  MEET_OR_FAIL;  // proposals before pairs read them
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
    look_for_near();
    MEET_OR_FAIL;  // what contacts propose before vertices take it
  }
  near = COUNTED(min(turn, 1u));
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

/// What is left of a substep where no collider is near: the reach of the frame.
void keep_reach() {
  EACH(i, VERTICES) {
    vec4 at = LOAD16(x, i);
    vec3 to = within_reach(i, at.xyz, at.w);
    if (to != at.xyz) STORE16(x, i, vec4(to, at.w));
    if (substep_now + 1u == p.substeps) note_way(i, to);
  }
}

bool substep_with(uint s, bool touches) {
  begin_substep(s);
  if (GRIPS > 0u) {
    EACH(g, GRIPS) move_grip(g, float(s + 1u) / float(p.substeps), p.frames_per_s);
    MEET_OR_FAIL;  // held vertices before all read them
  }
  uint near = 0u;
  turn = 0u;
  if (touches && MOVING != 0u && !respond_to_contact(near)) return false;
  if (!solve_lines(s, touches)) return false;
  if (!touches) {
    keep_reach();
    MEET_OR_FAIL;  // before the next substep's lines
    return true;
  }
  for (turn = 1u; turn < kTurns; ++turn)
    if (!respond_to_contact(near)) return false;
  if (near > 0u) {
    EACH(n, near) choose(pairs[n].w);
    MEET_OR_FAIL;  // planes before vertices are put before them
  }
  project_all(me, all_threads);
  forget_pushes(me, all_threads);
  if (me == 0u) COUNTED(1u) = 0u;
  MEET_OR_FAIL;  // the substep's end before the next one
  return true;
}

void main() {
  set_thread();
  lane = thread / BESIDE % LANES;
  uint group = gl_WorkGroupID.y * gl_NumWorkGroups.x + gl_WorkGroupID.x;
  chain = group * (THREADS / LANES) + thread / (LANES * BESIDE) * BESIDE + thread % BESIDE;
  me = group * THREADS + thread;
  all_threads = THREADS * gl_NumWorkGroups.x * gl_NumWorkGroups.y;
  [[unroll]] for (uint k = 0u; k < K; ++k) rest_pos[k] = rest_vel[k] = last_pos[k] = last_vel[k] = vec3(0.0);
#ifdef MANY_GROUPS
  if (p.passes == 0u) {  // asked only whether all can
    MEET;
    leave_grid_barrier();
    return;
  }
#endif
  if (ledger.far != 0u) return;  // the frame is done
  if (!list_pairs()) return;
  bool touches = ledger.pairs > 0u || PLANES > 0u;
  for (uint s = 0u; s < p.substeps; ++s)
    if (!substep_with(s, touches)) return;
  if (me == 0u) {
    faults.farthest = ledger.farthest;
    ledger.farthest = 0u;
  }
#ifdef MANY_GROUPS
  if (me < 3u) {
    ledger.cloth_low[me] = kLowNone;
    ledger.cloth_high[me] = kHighNone;
  }
  leave_grid_barrier();
#endif
}

#version 450
// Simulates `substeps` substeps of a cloth of at most 32 x 32 vertices in one workgroup, with state in shared memory.
#define SUBGROUPS
#include "common/common.glsl"
layout(std430, binding = BIND_POSITIONS) buffer Positions { vec4 x[]; };
layout(std430, binding = BIND_VELOCITIES) buffer Velocities { vec4 v[]; };
layout(std430, binding = BIND_POSITION_COMPENSATION) buffer PositionCompensation { vec4 rx[]; };
layout(std430, binding = BIND_VELOCITY_COMPENSATION) buffer VelocityCompensation { vec4 rv[]; };
layout(std430, binding = BIND_LAST_POSITIONS) buffer LastPositions { vec4 lx[]; };
layout(std430, binding = BIND_LAST_VELOCITIES) buffer LastVelocities { vec4 lv[]; };
layout(std430, binding = BIND_GRIPS) readonly buffer Grips { GripVertex grips[]; };
#ifdef CONTACT_FREE
layout(std430, binding = BIND_FRAME_STATE) buffer FrameState { ContactFrameState frame_state; };
layout(std430, binding = BIND_DIAGNOSTICS) writeonly buffer Diagnostics { ContactDiagnostics diagnostics; };
layout(std430, binding = BIND_SHAPE_AABBS) readonly buffer ShapeAabbs { ShapeAabb boxes[]; };  // shapes, then groups
CONTACT_CONSTANTS(SPECIALIZE)
const uint SELF = 0u;
#endif
#include "xpbd/lines/grid_lines.glsl"

// 34 words per row: with 4 vertices per thread, at most two threads access a bank at once, in every colour.
const uint kStride = 34u;
shared float px[kStride * ROWS], py[kStride * ROWS], pz[kStride * ROWS];
shared float vx[kStride * ROWS], vy[kStride * ROWS], vz[kStride * ROWS];
shared uint held[32];  // one bit per vertex, one word per row
// Shifts along rows (u) and columns (v), and the first stages of their filters, divided by h'^2.
const uint kShifts = kCorrectsSplitting ? kStride * ROWS : 1u;
shared float su[kShifts], sv[kShifts], filter_u[kShifts], filter_v[kShifts];

void put_shift(uvec2 at, vec4 value) {
  uint o = at.y * kStride + at.x;
  su[o] = value.x;
  sv[o] = value.y;
  filter_u[o] = value.z;
  filter_v[o] = value.w;
}

#ifdef CONTACT_FREE
#define CLOTH_LOW cloth_low
#define CLOTH_HIGH cloth_high
shared uint any_nearby;
#include "xpbd/contact/broad_phase/cloth_aabb.glsl"
#include "xpbd/contact/displacement_filter/contact_motion_bounds.glsl"
#include "xpbd/fused/contact_free_frame.glsl"
#endif

vec3 anchor(uvec2 at, uint k) {
  uint o = at.y * kStride + at.x;
  return vec3(px[o], py[o], pz[o]);
}
#include "xpbd/lines/integrate_lines.glsl"

float inverse_mass(uvec2 at) {
  if ((held[at.y] >> at.x & 1u) != 0u) return 0.0;
  bool side = at.x == 0u || at.x + 1u == COLUMNS, end = at.y == 0u || at.y + 1u == ROWS;
  return p.inverse_mass * (side ? 2.0 : 1.0) * (end ? 2.0 : 1.0);
}

void put(uvec2 at, vec3 position, vec3 velocity) {
  uint o = at.y * kStride + at.x;
  px[o] = position.x;
  py[o] = position.y;
  pz[o] = position.z;
  vx[o] = velocity.x;
  vy[o] = velocity.y;
  vz[o] = velocity.z;
}

/// Reads the thread's vertices on its chain of `colour` from shared memory.
void take() {
  [[unroll]] for (uint k = 0u; k < K; ++k) {
    uint i = lane * K + k;
    uvec2 at = on_chain(i) ? vertex(i) : uvec2(0u);
    uint o = at.y * kStride + at.x;
    pos[k] = vec3(px[o], py[o], pz[o]);
    vel[k] = vec3(vx[o], vy[o], vz[o]);
    w[k] = on_chain(i) ? inverse_mass(at) : 0.0;
    if (kCorrectsSplitting)
      shift[k] = w[k] > 0.0 ? p.h * p.h * vec4(su[o], sv[o], filter_u[o], filter_v[o]) : vec4(0.0);
  }
}

void give() {
  [[unroll]] for (uint k = 0u; k < K; ++k)
    if (w[k] > 0.0) put(vertex(lane * K + k), pos[k], vel[k]);
  [[unroll]] for (uint k = 0u; kCorrectsSplitting && k < K; ++k)
    if (w[k] > 0.0 && colour < 2u) put_shift(vertex(lane * K + k), p.per_h * p.per_h * shift[k]);
}

void load() {
  if (thread < 32u) held[thread] = 0u;
  barrier();  // wait for cleared bits before threads set them
  [[unroll]] for (uint k = 0u; k < K; ++k) {
    uint i = lane * K + k;
    if (!on_chain(i)) continue;
    uint o = index_of(vertex(i));
    vec4 here = x[o];
    put(vertex(i), here.xyz, v[o].xyz);
    if (kCorrectsSplitting) put_shift(vertex(i), shifts[o]);
    rest_pos[k] = rx[o].xyz;
    rest_vel[k] = rv[o].xyz;
    if (kUsesBdf2) {
      last_pos[k] = lx[o].xyz;
      last_vel[k] = lv[o].xyz;
    }
    if (here.w == 0.0) atomicOr(held[vertex(i).y], 1u << vertex(i).x);
  }
  barrier();  // wait for the bits of held vertices before attachments change them
  for (uint g = thread; g < GRIPS; g += THREADS) {
    GripVertex grip = grips[g];
    uint bit = 1u << grip.vertex % COLUMNS;
    if (grip.held != 0u) atomicOr(held[grip.vertex / COLUMNS], bit);
    else atomicAnd(held[grip.vertex / COLUMNS], ~bit);
  }
}

void store() {
  [[unroll]] for (uint k = 0u; k < K; ++k) {
    uint i = lane * K + k;
    if (!on_chain(i)) continue;
    uint o = index_of(vertex(i));
    x[o] = vec4(pos[k], w[k]);
    v[o] = vec4(vel[k], 0.0);
    uint at = vertex(i).y * kStride + vertex(i).x;  // copied unscaled, so results do not depend on where dispatches end
    if (kCorrectsSplitting) shifts[o] = vec4(su[at], sv[at], filter_u[at], filter_v[at]);
    rx[o] = vec4(rest_pos[k], 0.0);
    rv[o] = vec4(rest_vel[k], 0.0);
    if (!kUsesBdf2) continue;
    lx[o] = vec4(last_pos[k], 0.0);
    lv[o] = vec4(last_vel[k], 0.0);
  }
}

/// Moves attached vertices along a straight line through the frame.
void move_held(uint substep) {
  barrier();  // wait for the last substep's reads before attached vertices move
  // Equals the quotient that the host passes to move_grips; a multiple of substep_part would round differently.
  float fraction = float(p.first_substep + substep + 1u) / floor(1.0 / p.substep_part + 0.5);
  for (uint g = thread; g < GRIPS; g += THREADS) {
    GripVertex grip = grips[g];
    if (grip.held == 0u) continue;
    put(uvec2(grip.vertex % COLUMNS, grip.vertex / COLUMNS),
        grip.from.xyz * (1.0 - fraction) + grip.to.xyz * fraction,
        (grip.to.xyz - grip.from.xyz) * p.frames_per_s);
  }
  barrier();  // wait for attached vertices before threads read them
}

void main() {
  set_thread();
  lane = thread % LANES;
  chain = thread / LANES;
  const uint colours = kShears ? 4u : 2u;
  colour = colours - 1u;
  [[unroll]] for (uint k = 0u; k < K; ++k) rest_pos[k] = rest_vel[k] = last_pos[k] = last_vel[k] = vec3(0.0);
#ifdef CONTACT_FREE
  if (!cannot_reach_any_collider()) return;
  const float last_h = frame_state.last_h;
#endif
  load();
  barrier();  // wait for load() before threads read the state
  for (uint s = 0u; s < p.substeps; ++s) {
#ifdef CONTACT_FREE
    kick_scale = kick_scale_after(s == 0u ? last_h : p.h);
#endif
    if (GRIPS > 0u) move_held(s);
    for (uint turn = 0u; turn < colours; ++turn) {
      colour = colours - 1u - turn;
      take();
      if (turn == 0u) integrate();
      if (kBends && colour < 2u) bend();
      stretch();
      give();
#ifdef CONTACT_FREE
      if (turn + 1u == colours) check_motion_bound();
#endif
      barrier();  // wait for this colour's writes before the next colour reads them
    }
  }
#ifdef CONTACT_FREE
  if (any_nearby != 0u) return;
  if (thread == 0u) {
    frame_state.contact_free = 1u;
    frame_state.contact_possible = 0u;
    frame_state.last_h = p.h;
  }
#endif
  colour = colours - 1u;  // the colour to whose chains the compensation terms belong
  take();
#ifdef CONTACT_FREE
  record_max_displacement();
#endif
  store();
}

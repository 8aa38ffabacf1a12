// Passes per vertex: prediction at a substep's start, and the clamp to the motion bound after the constraint solve.

#ifndef FUSED_FRAME
const float kick_scale = 1.0;
#endif

/// Limit of a vertex's displacement in the substep [m]: the distance to `to`, plus room for contact corrections. Pairs
/// of layers within both of their limits are active, so layers have less room.
float max_displacement(uint i, vec3 to) {
  float travel = distance(to, starts[i].xyz), room = MARGIN_M;
  if (SELF != 0u) room = travel + ROOM_BESIDE_LAYERS;
  return travel + p.substep_part * frame_state.max_shape_displacement + room;
}

/// Clears the bits of proposed corrections and, with `all`, of active pairs. Thread `first` of `at_once` threads
/// clears its part.
void clear_bits(uint first, uint at_once, bool all) {
  for (uint k = first, words = (frame_state.pairs + 31u) / 32u; k < words; k += at_once) {
    active_bits[CORRECTION_BITS + k] = 0u;
    if (all) active_bits[ACTIVE_BITS + k] = 0u;
  }
}

/// Unscaled inverse mass of vertex i: from y, or `in_lines` (from x) if it is attached or was just released.
float mass_of(uint i, float in_lines) {
  float w = y[i].w;
  return in_lines == 0.0 || w == 0.0 ? in_lines : w;
}

/// Predicts vertex i without constraints and contact. Tethers are part of the constraint solve.
void predict(uint i) {
  vec4 at = x[i];
  vec3 vel = v[i].xyz;
  at.w = mass_of(i, at.w);
  if (at.w > 0.0) at.xyz += p.h * (vel + kick_scale * (p.gravity_h.xyz - p.damping_fraction * vel));
  y[i] = at;
  starts[i].w = max_displacement(i, at.xyz);
}

/// `to`, moved back to at most `largest` [m] from `from`; the velocity changes by the cut part divided by h'.
vec3 clamp_to(uint i, vec3 to, float w, vec3 from, float largest) {
  vec3 displacement = to - from;
  float l = length(displacement);
  if (!(w > 0.0 && l > largest)) return to;
  vec3 kept = from + (largest / l) * displacement;
  v[i] = vec4(v[i].xyz + p.per_h * (kept - to), 0.0);
  return kept;
}
/// `to`, clamped to vertex i's motion bounds of the frame.
vec3 clamp_to_bounds(uint i, vec3 to, float w) {
  vec4 bound = motion_bounds[i];
  return SHAPES > 0u ? clamp_to(i, to, w, bound.xyz, bound.w * frame_state.bound_fraction) : to;
}

void clamp_to_motion_bound(uint i, vec4 at) {
  float w = mass_of(i, at.w);
  vec3 to = clamp_to_bounds(i, at.xyz, w);
  y[i] = vec4(to, w);
  if (SECOND_SOLVE && response_round > 1u) return;
  starts[i].w = max_displacement(i, to);
  if (SELF == 0u) return;
  SelfBounds of_list = self_bounds[i];
  vec3 low = min(starts[i].xyz, to), high = max(starts[i].xyz, to);
  if (!(all(greaterThanEqual(low, of_list.low.xyz)) && all(lessThanEqual(high, of_list.high.xyz))))
    frame_state.self_list_expired = 1u;
}

// Vertices at a substep's start (prediction), and after its constraints (clamp to the motion bound).

/// How far a vertex may go from its start: its proposed displacement, and what a collider may push it.
float max_displacement(uint i, vec3 to) {
  return distance(to, starts[i].xyz) + p.substep_part * frame_state.max_shape_displacement + MARGIN_M;
}

/// Before pairs are processed whether they are active. Thread `first` of `at_once` takes its share.
void clear_active_bits(uint first, uint at_once) {
  for (uint k = first, words = (frame_state.pairs + 31u) / 32u; k < words; k += at_once)
    active_bits[ACTIVE_BITS + k] = active_bits[CORRECTION_BITS + k] = 0u;
}

/// Clears only the bits of proposed corrections, after the vertices have applied them.
void clear_correction_bits(uint first, uint at_once) {
  for (uint k = first, words = (frame_state.pairs + 31u) / 32u; k < words; k += at_once)
    active_bits[CORRECTION_BITS + k] = 0u;
}

/// Inverse mass of a vertex that has `in_lines` there. Hands hold and released between the two.
float mass_of(uint i, float in_lines) {
  float w = y[i].w;
  return in_lines == 0.0 || w == 0.0 ? in_lines : w;
}

/// Where a vertex would be without links and contact. Tethers come with the lines.
void predict(uint i) {
  vec4 at = x[i];
  vec3 vel = v[i].xyz;
  at.w = mass_of(i, at.w);
  if (at.w > 0.0) at.xyz += p.h * (vel + p.gravity_h.xyz - p.damping_fraction * vel);
  y[i] = at;
  starts[i].w = max_displacement(i, at.xyz);
}

/// `to`, but no farther than `largest` from `from`; the velocity loses what is cut off.
vec3 clamp_to(uint i, vec3 to, float w, vec3 from, float largest) {
  vec3 displacement = to - from;
  float l = length(displacement);
  if (!(w > 0.0 && l > largest)) return to;
  vec3 kept = from + (largest / l) * displacement;
  v[i] = vec4(v[i].xyz + p.per_h * (kept - to), 0.0);
  return kept;
}
/// `to` within the frame's motion bound.
vec3 clamp_to_bounds(uint i, vec3 to, float w) {
  vec4 bound = motion_bounds[i];
  if (SELF != 0u) {
    vec3 drift = (t_end * p.frame_s) * drift_velocity();
    to = clamp_to(i, to, w, bound.xyz + drift, drift_m() + bound.w * frame_state.self_bound_fraction);
  }
  return clamp_to(i, to, w, bound.xyz, (bound.w + 2.0 * drift_m()) * frame_state.bound_fraction);
}

void clamp_to_motion_bound(uint i, vec4 at) {
  float w = mass_of(i, at.w);
  vec3 to = clamp_to_bounds(i, at.xyz, w);
  y[i] = vec4(to, w);
  if (!SECOND_SOLVE || response_round < 2u) starts[i].w = max_displacement(i, to);
}

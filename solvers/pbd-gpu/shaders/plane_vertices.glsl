// What plane contact does with a vertex at a substep's start and after its constraints.

/// How far a vertex may go from its start: its proposed way, and what a collider may push it.
float farthest(uint i, vec3 to) {
  return distance(to, starts[i].xyz) + p.substep_part * ledger.carried + MARGIN_M;
}

/// Before pairs are asked whether they are near. Thread `first` of `at_once` takes its share.
void forget_near(uint first, uint at_once) {
  for (uint k = first, words = (ledger.pairs + 31u) / 32u; k < words; k += at_once) near_bits[NEAR_BITS + k] = near_bits[PUSH_BITS + k] = 0u;
}

/// The same of what contacts propose alone, once vertices have taken it.
void forget_pushes(uint first, uint at_once) {
  for (uint k = first, words = (ledger.pairs + 31u) / 32u; k < words; k += at_once) near_bits[PUSH_BITS + k] = 0u;
}

/// Inverse mass of a vertex that has `in_lines` there. Hands hold and let go between the two.
float mass_of(uint i, float in_lines) {
  float w = LOAD16(y, i).w;
  return in_lines == 0.0 || w == 0.0 ? in_lines : w;
}

/// Where a vertex would be without links and contact. Tethers come with the lines.
void predict(uint i) {
  vec4 at = LOAD16(x, i);
  vec3 vel = LOAD16(v, i).xyz;
  at.w = mass_of(i, at.w);
  if (at.w > 0.0) at.xyz += p.h * (vel + p.gravity_h.xyz - p.loss * vel);
  STORE16(y, i, at);
  starts[i].w = farthest(i, at.xyz);
}

/// Where the lines have put a vertex, but no farther than `most` from where it began.
vec3 within_most(uint i, vec3 to, float w, vec3 from, float most) {
  vec3 way = to - from;
  float l = length(way);
  if (!(w > 0.0 && l > most)) return to;
  vec3 kept = from + (most / l) * way;
  STORE16(v, i, vec4(LOAD16(v, i).xyz + p.per_h * (kept - to), 0.0));
  return kept;
}
/// The same within the frame's reach.
vec3 within_reach(uint i, vec3 to, float w) {
  vec4 reach = LOAD16(reaches, i);
  if (SELF != 0u) {
    vec3 drift = (t_end * p.frame_s) * vec3(ledger.drift[0], ledger.drift[1], ledger.drift[2]);
    to = within_most(i, to, w, reach.xyz + drift, reach.w * ledger.self_reach);
  }
  return within_most(i, to, w, reach.xyz, (reach.w + drift_m()) * ledger.reach);
}

void settle(uint i, vec4 at) {
  float w = mass_of(i, at.w);
  vec3 to = within_reach(i, at.xyz, w);
  STORE16(y, i, vec4(to, w));
  if (!AGAIN || turn < 2u) starts[i].w = farthest(i, to);
}

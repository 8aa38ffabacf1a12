// Start of a frame: how far each vertex may go in it. The list of pairs is made for that, and vertices keep to it.

// In a frame a vertex may go several times as far as at its speed: a corner that whips, or what hands let go of. A vertex that would go
// farther is held back, and the momentum of the cloth changes with nothing near.
#define REACH_FACTOR (GRIPS > 0u ? 8.0 : SELF > 0u ? 1.0 : 4.0)  // lists of the cloth with itself have place for no more

/// Greatest displacement of a point of any piece in the frame.
float greatest_displacement() {
  float carried = 0.0;
  for (uint g = 0u; MOVING != 0u && g < GROUPS; ++g) carried = max(carried, LOAD16_OF(boxes[PIECES + g].low).w);
  return carried;
}

/// Whether the cloth goes no farther in a frame than about a cell. What is faster takes the substeps of contact in each frame that is near a
/// collider: an impact strains it, and that grows with fewer.
bool is_slow() { return uintBitsToFloat(ledger.farthest) <= 2.0 * p.reach_m; }

/// Reach of a vertex at rest: what may pull it along moves itself. Where nothing went far in the last frame, lists are short. Without a
/// frame before, it is the greatest.
float reach_at_rest() {
  const float kShare = 0.2, kWays = 2.0;
  float fall = length(p.gravity_h.xyz) * float(p.substeps) * p.frame_s, last = uintBitsToFloat(ledger.farthest);
  return last > 0.0 ? min(p.reach_m, kShare * p.reach_m + (1.0 - kShare) * fall + kWays * last) : p.reach_m;
}

/// By the hand that goes farthest: it may take any vertex along.
float pulled() {
  float most = 0.0;
  for (uint k = 0u; k < GRIPS; ++k) {
    GripVertex grip = LOAD(48u, grips, k);
    if (grip.held != 0u) most = max(most, distance(LOAD16(x, grip.vertex).xyz, grip.to.xyz));
  }
  return most;
}

/// Mean velocity of a few vertices of cloth that touches itself: what all of it does brings no two triangles together. Every velocity is
/// right, for vertices keep to a reach around it.
vec3 drift() {
  vec3 all = vec3(0.0);
  for (uint k = 0u; SELF != 0u && k < 4u; ++k) all += 0.25 * LOAD16(v, (2u * k + 1u) * VERTICES / 8u).xyz;
  return all;
}

/// The reach of a vertex by its speed.
float reach_at(float speed, float rest, float carried, float by_hands) {
  return REACH_FACTOR * (rest + 1.5 * speed * p.frame_s) + carried + by_hands;
}
/// The same in a frame in which it meets no collider.
float free_reach_at(float speed, float rest, float by_hands) {
  return REACH_FACTOR * (min(rest, 0.5 * p.reach_m) + 1.25 * speed * p.frame_s) + by_hands;
}

#if !defined(FAR) || defined(PLANE_FRAME)
/// The same in .w of its place, and kept for the frame.
vec4 reach_of_vertex(uint i, float carried) {
  vec4 at = LOAD16(x, i);
  vec3 along = drift();
  float speed = length(LOAD16(v, i).xyz - along), rest = reach_at_rest(), by_hands = pulled();
  float reach = reach_at(speed, rest, carried, by_hands);
#ifdef PLANE_FRAME
  STORE16(starts, i, vec4(at.xyz, free_reach_at(speed, rest, by_hands)));
#else
  STORE16(starts, i, vec4(at.xyz, 0.0));
#endif
  STORE16(y, i, at);
  STORE16(reaches, i, vec4(at.xyz, reach));
  STORE4(ways, i, 0.0);
  return vec4(at.xyz, reach + length(along) * p.frame_s);
}
#endif

// Conservative bound of a vertex's motion in the frame: boxes are inflated by it, and vertices are clamped to it.

// A vertex may move several times as far in a frame as its speed predicts: a whipping corner, or released cloth. With a
// smaller factor such vertices would be clamped, which changes the cloth's momentum without contact.
#define BOUND_FACTOR (GRIPS > 0u ? 8.0 : 4.0)

/// Maximum displacement of a point of any convex shape in the frame.
float max_displacement_of_shapes() {
  float max_shape_displacement = 0.0;
  for (uint g = 0u; HAS_KINEMATIC != 0u && g < GROUPS; ++g)
    max_shape_displacement = max(max_shape_displacement, boxes[SHAPES + g].low.w);
  return max_shape_displacement;
}

/// Whether no vertex moved farther than about a cell in the last frame. Faster cloth near a collider always uses the
/// number of substeps for contact, because with fewer an impact strains the cloth more.
bool is_slow() { return uintBitsToFloat(frame_state.max_displacement) <= 2.0 * p.bound_m; }

/// Speed-independent part of a vertex's motion bound [m]: from the cloth's largest displacement in the last frame,
/// because a vertex at rest is only pulled along by others that move. Without a previous frame: the maximum, bound_m.
float bound_at_rest() {
  const float kFraction = 0.2, kWays = 2.0;
  float fall = length(p.gravity_h.xyz) * float(p.substeps) * p.frame_s;
  float last = uintBitsToFloat(frame_state.max_displacement);
  return last > 0.0 ? min(p.bound_m, kFraction * p.bound_m + (1.0 - kFraction) * fall + kWays * last) : p.bound_m;
}

/// Largest displacement of an attached vertex in the frame [m]; any vertex may be pulled along by as much.
float pulled() {
  float largest = 0.0;
  for (uint k = 0u; k < GRIPS; ++k) {
    GripVertex grip = grips[k];
    if (grip.held != 0u) largest = max(largest, distance(x[grip.vertex].xyz, grip.to.xyz));
  }
  return largest;
}

/// Motion bound of a vertex in a frame with contact [m].
float motion_bound(float speed, float rest, float max_shape_displacement, float by_hands) {
  return BOUND_FACTOR * (rest + 1.5 * speed * p.frame_s) + max_shape_displacement + by_hands;
}
/// Motion bound of a vertex in a contact-free frame [m].
float contact_free_bound(float speed, float rest, float by_hands) {
  return BOUND_FACTOR * (min(rest, 0.5 * p.bound_m) + 1.25 * speed * p.frame_s) + by_hands;
}

#if !defined(CONTACT_FREE) || defined(FUSED_FRAME)
/// Stores vertex i's start and motion bound of the frame. Returns its position; w: bound [m].
vec4 motion_bound_of_vertex(uint i, float max_shape_displacement) {
  vec4 at = x[i];
  float speed = length(v[i].xyz), rest = bound_at_rest(), by_hands = pulled();
  float bound = motion_bound(speed, rest, max_shape_displacement, by_hands);
#ifdef FUSED_FRAME
  starts[i] = vec4(at.xyz, contact_free_bound(speed, rest, by_hands));
#else
  starts[i] = vec4(at.xyz, 0.0);
#endif
  y[i] = at;
  motion_bounds[i] = vec4(at.xyz, bound);
  vertex_displacement[i] = 0.0;
  return vec4(at.xyz, bound);
}
#endif

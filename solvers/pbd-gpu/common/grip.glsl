// Vertices that a hand attaches go where it takes them, on a straight line through the frame, and have no inverse mass.
// Once released they have theirs, and keep the position and velocity they had.
void move_grip(uint k, float fraction, float per_frame_s) {
  GripVertex g = grips[k];
  vec4 at = x[g.vertex], vel = v[g.vertex];
  bool held = g.held != 0u;
  // Written so that fractions 0 and 1 give the very ends.
  vec3 to = g.from.xyz * (1.0 - fraction) + g.to.xyz * fraction;
  x[g.vertex] = held ? vec4(to, 0.0) : vec4(at.xyz, g.free_inverse_mass);
  v[g.vertex] = held ? vec4((g.to.xyz - g.from.xyz) * per_frame_s, 0.0) : vec4(vel.xyz, g.free_inverse_mass);
}

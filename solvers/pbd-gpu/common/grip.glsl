// Attached vertices move along a straight line through the frame and have inverse mass 0. Released vertices get their
// inverse mass back, and keep position and velocity.
void move_grip(uint k, float fraction, float per_frame_s) {
  GripVertex g = grips[k];
  vec4 at = x[g.vertex], vel = v[g.vertex];
  bool held = g.held != 0u;
  // In this form fractions 0 and 1 give exactly `from` and `to`.
  vec3 to = g.from.xyz * (1.0 - fraction) + g.to.xyz * fraction;
  x[g.vertex] = held ? vec4(to, 0.0) : vec4(at.xyz, g.free_inverse_mass);
  v[g.vertex] = held ? vec4((g.to.xyz - g.from.xyz) * per_frame_s, 0.0) : vec4(vel.xyz, g.free_inverse_mass);
}

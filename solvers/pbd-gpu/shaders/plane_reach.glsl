// Start of a frame: how far each vertex may go in it. The list of pairs is made for that, and vertices keep to it.

// What hands let go of springs back farther than it moved in the frame before.
#define HELD_REACH (GRIPS > 0u ? 8.0 : 1.0)

/// Greatest displacement of a point of any piece in the frame.
float greatest_displacement() {
  float carried = 0.0;
  for (uint g = 0u; MOVING != 0u && g < GROUPS; ++g) carried = max(carried, LOAD16_OF(boxes[PIECES + g].low).w);
  return carried;
}

/// The reach of vertex i at `at`.
float reach_from(uint i, vec4 at, float carried) {
  float pulled = 0.0;  // by the hand that goes farthest: it may take any vertex along
  for (uint k = 0u; k < GRIPS; ++k) {
    GripVertex grip = LOAD(48u, grips, k);
    if (grip.held != 0u) pulled = max(pulled, distance(LOAD16(x, grip.vertex).xyz, grip.to.xyz));
  }
  return HELD_REACH * (p.reach_m + 1.5 * length(LOAD16(v, i).xyz) * p.frame_s) + carried + pulled;
}

#ifndef FAR
/// The same in .w of its place, and kept for the frame.
vec4 reach_of_vertex(uint i, float carried) {
  vec4 at = LOAD16(x, i);
  float reach = reach_from(i, at, carried);
  STORE16(starts, i, vec4(at.xyz, 0.0));
  STORE16(y, i, at);
  STORE16(reaches, i, vec4(at.xyz, reach));
  STORE4(ways, i, 0.0);
  return vec4(at.xyz, reach);
}
#endif

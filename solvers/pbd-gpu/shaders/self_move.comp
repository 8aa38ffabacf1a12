#version 450
// End of self-contact in a substep: every free vertex moves by the certified part of its displacement.
#include "common.glsl"
layout(std430, binding = BIND_STARTS) buffer Starts { vec4 starts[]; };
layout(std430, binding = BIND_POSITIONS) buffer Positions { vec4 x[]; };
layout(std430, binding = BIND_PART) readonly buffer Part { uint part[]; };
layout(push_constant) uniform Push { SelfConstants p; };

void main() {
  uint i = item();
  if (i >= p.columns * p.rows) return;
  float most = uintBitsToFloat(LOAD4(part, 0));
  vec4 to = LOAD16(x, i);
  vec3 from = LOAD16(starts, i).xyz;
  // Not by the sum where all of it is free: from + (to - from) is not `to` in its last digit.
  if (most < 1.0 && to.w != 0.0) to.xyz = from + most * (to.xyz - from);
  STORE16(x, i, to);
  STORE16(starts, i, to);
}

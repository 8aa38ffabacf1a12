#version 450
// Vertices that are welded to another go where it goes.
#include "common/common.glsl"
layout(std430, binding = BIND_POSITIONS) buffer Positions { vec4 x[]; };
layout(std430, binding = BIND_VELOCITIES) buffer Velocities { vec4 v[]; };
layout(std430, binding = BIND_WELDS) readonly buffer Welds { uvec2 welds[]; };  // a vertex, and the one it follows
layout(push_constant) uniform Push { uint count; };

void main() {
  uint i = item();
  if (i >= count) return;
  uvec2 w = welds[i];
  vec4 here = x[w.y], speed = v[w.y];
  x[w.x] = here;
  v[w.x] = speed;
}

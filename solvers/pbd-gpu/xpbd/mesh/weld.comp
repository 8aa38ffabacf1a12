#version 450
// Copies position and velocity to each welded vertex from the vertex that it is welded to.
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

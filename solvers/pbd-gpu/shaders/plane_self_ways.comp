#version 450
// Twice a substep, a thread a triangle.
#include "common.glsl"
#include "plane_buffers.glsl"
layout(std430, binding = BIND_STARTS) readonly buffer Starts { vec4 starts[]; };
layout(std430, binding = BIND_WAYS) readonly buffer Ways { float ways[]; };
layout(std430, binding = BIND_SELF_WAYS) writeonly buffer SelfWays { vec4 self_ways[]; };
#include "plane_self_ways.glsl"

void main() {
  for (uint t = item(); t < TRIANGLES; t += stride()) ways_of_triangle(t);
}

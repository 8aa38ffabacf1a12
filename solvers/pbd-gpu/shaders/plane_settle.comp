#version 450
// After the lines, a thread a vertex: where they have put it, within the frame's reach.
#extension GL_GOOGLE_include_directive : require
#include "common.glsl"
#include "plane_buffers.glsl"
#include "plane_vertices.glsl"
layout(std430, binding = BIND_REACHES) readonly buffer Reaches { vec4 reaches[]; };

void main() {
  uint i = item();
  if (i >= p.vertices) return;
  vec3 to = LOAD16(x, i).xyz;
  float w = LOAD16(y, i).w;
  vec4 reach = LOAD16(reaches, i);
  vec3 way = to - reach.xyz;
  float l = length(way), most = reach.w * ledger.reach;
  if (w > 0.0 && l > most) {
    vec3 kept = reach.xyz + (most / l) * way;
    STORE16(v, i, vec4(LOAD16(v, i).xyz + p.per_h * (kept - to), 0.0));
    to = kept;
  }
  STORE16(y, i, vec4(to, w));
  starts[i].w = farthest(i, to);
}

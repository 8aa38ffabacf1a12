#version 450
// Kim, Ma & Hong 2025, 3.2.3: every particle against every box; out through the nearest face of the box grown by the
// margin.
#include "common/common.glsl"
#include "paper/particle_contact.glsl"
layout(std430, binding = BIND_BOXES) readonly buffer Boxes { BoxShape boxes[]; };

vec3 out_of_box(vec3 at, vec3 from, BoxShape b) {
  vec3 d = at - b.center.xyz;
  vec3 local = vec3(dot(d, b.axis_x.xyz), dot(d, b.axis_y.xyz), dot(d, b.axis_z.xyz));
  vec3 depth = vec3(b.axis_x.w, b.axis_y.w, b.axis_z.w) + b.margin - abs(local);
  if (!(min(depth.x, min(depth.y, depth.z)) > 0.0)) return at;
  if (depth.x <= depth.y && depth.x <= depth.z)
    return touched(at, from, local.x < 0.0 ? -b.axis_x.xyz : b.axis_x.xyz, depth.x, b.friction);
  if (depth.y <= depth.z) return touched(at, from, local.y < 0.0 ? -b.axis_y.xyz : b.axis_y.xyz, depth.y, b.friction);
  return touched(at, from, local.z < 0.0 ? -b.axis_z.xyz : b.axis_z.xyz, depth.z, b.friction);
}

vec3 satisfied(vec3 at, vec3 from) {
  for (uint k = 0u; k < p.count; ++k) at = out_of_box(at, from, boxes[k]);
  return at;
}
#include "paper/each_particle.glsl"

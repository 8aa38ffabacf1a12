#version 450
// Kim, Ma & Hong 2025, 3.2.4 (room) and 3.2.6, Algorithm 4 (hand): every particle against every triangle, no broad
// phase. A particle whose projection is in the triangle, nearer than the margin in front or than the depth behind,
// is put at the margin along the triangle's normal.
#include "common/common.glsl"
#include "paper/particle_contact.glsl"
layout(std430, binding = BIND_TRIANGLES) readonly buffer Triangles { uvec4 triangles[]; };
layout(std430, binding = BIND_MESH_VERTICES) readonly buffer Vertices { vec4 vertex[]; };

bool projects_into(vec3 d, vec3 ab, vec3 ac, vec3 normal) {
  float u = dot(cross(d, ac), normal), v = dot(cross(ab, d), normal);
  return u >= 0.0 && v >= 0.0 && u + v <= dot(cross(ab, ac), normal);
}

vec3 satisfied(vec3 at, vec3 from) {
  for (uint k = 0u; k < p.count; ++k) {
    uvec4 t = triangles[p.first + k];
    vec3 a = vertex[t.x].xyz, ab = vertex[t.y].xyz - a, ac = vertex[t.z].xyz - a;
    vec3 normal = cross(ab, ac), d = at - a;
    float area = length(normal);
    if (!(area > 0.0)) continue;
    normal /= side * area;
    float height = dot(d, normal);
    if (height < p.margin && height > -p.depth && projects_into(d, ab, ac, side * normal))
      at = touched(at, from, normal, p.margin - height, p.friction);
  }
  return at;
}
#include "paper/each_particle.glsl"

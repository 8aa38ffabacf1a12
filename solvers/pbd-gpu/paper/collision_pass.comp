#version 450
// The collision kernels of `paper` (Kim, Ma & Hong 2025, 3.2.3 to 3.2.6): one thread per particle, which is tested
// against every shape or triangle of one kind. CMakeLists.txt compiles this file once per kernel.
#include "common/common.glsl"
layout(std430, binding = BIND_SPHERES) readonly buffer Spheres { SphereShape spheres[]; };
layout(std430, binding = BIND_BOXES) readonly buffer Boxes { BoxShape boxes[]; };
layout(std430, binding = BIND_CAPSULES) readonly buffer Capsules { CapsuleShape capsules[]; };
layout(std430, binding = BIND_TRIANGLES) readonly buffer Triangles { uvec4 triangles[]; };
layout(std430, binding = BIND_MESH_VERTICES) readonly buffer Vertices { vec4 vertex[]; };
layout(std430, binding = BIND_PREDICTED) buffer Predicted { vec4 q[]; };
layout(std430, binding = BIND_POSITIONS) readonly buffer Positions { vec4 x[]; };  // at the step's start
layout(std430, binding = BIND_SLIP) buffer Slip { vec4 slip[]; };  // displacement that velocities leave out
layout(push_constant) uniform Push { PaperContactConstants p; };
PAPER_CONSTANTS(SPECIALIZE)

float side;                // -1: triangles push against their normals
vec3 removed = vec3(0.0);  // tangential displacement that friction removes from the velocity

/// Moves `at` by `push` along `normal`; friction removes a fraction of the tangential displacement since `from`.
vec3 touched(vec3 at, vec3 from, vec3 normal, float push, float friction) {
  at += push * normal;
  if (FRICTION == 0u) return at;
  vec3 displacement = at - from;
  vec3 taken = min(friction, 1.0) * (displacement - dot(displacement, normal) * normal);
  if (FRICTION == 1u) return at - taken;
  removed += taken;
  return at;
}

/// Moves `at` out of the ball of radius `reach` around `center`; a particle exactly at the centre stays there.
vec3 out_of_ball(vec3 at, vec3 from, vec3 center, float reach, float friction) {
  vec3 d = at - center;
  float l = length(d);
  return l < reach && l > 0.0 ? touched(at, from, d / l, reach - l, friction) : at;
}

#if defined(SPHERE_COLLISIONS)
vec3 satisfied(vec3 at, vec3 from, uint k) {
  SphereShape s = spheres[k];
  return out_of_ball(at, from, s.center.xyz, s.radius + s.margin, s.friction);
}

#elif defined(CUBE_COLLISIONS)  // moves out through the nearest face of the box inflated by the margin
vec3 satisfied(vec3 at, vec3 from, uint k) {
  BoxShape b = boxes[k];
  vec3 d = at - b.center.xyz;
  vec3 local = vec3(dot(d, b.axis_x.xyz), dot(d, b.axis_y.xyz), dot(d, b.axis_z.xyz));
  vec3 depth = vec3(b.axis_x.w, b.axis_y.w, b.axis_z.w) + b.margin - abs(local);
  if (!(min(depth.x, min(depth.y, depth.z)) > 0.0)) return at;
  if (depth.x <= depth.y && depth.x <= depth.z)
    return touched(at, from, local.x < 0.0 ? -b.axis_x.xyz : b.axis_x.xyz, depth.x, b.friction);
  if (depth.y <= depth.z) return touched(at, from, local.y < 0.0 ? -b.axis_y.xyz : b.axis_y.xyz, depth.y, b.friction);
  return touched(at, from, local.z < 0.0 ? -b.axis_z.xyz : b.axis_z.xyz, depth.z, b.friction);
}

#elif defined(CAPSULE_COLLISIONS)
// 3.2.5, Algorithm 3: capsules of a hand at the frame's end; moves out of the ball around the segment's nearest point.
vec3 satisfied(vec3 at, vec3 from, uint k) {
  vec4 a = capsules[k].a1, b = capsules[k].b1;
  vec3 ab = b.xyz - a.xyz;
  float squared = dot(ab, ab);
  float t = squared > 0.0 ? clamp(dot(at - a.xyz, ab) / squared, 0.0, 1.0) : 0.0;
  return out_of_ball(at, from, a.xyz + t * ab, a.w, b.w);
}

#elif defined(MESH_COLLISIONS)
// 3.2.4 (room) and 3.2.6, Algorithm 4 (hand), without broad phase. A particle whose projection is in the triangle, and
// which is less than the margin in front of it or less than the depth behind it, moves along the normal to the margin.
bool projects_into(vec3 d, vec3 ab, vec3 ac, vec3 normal) {
  float u = dot(cross(d, ac), normal), v = dot(cross(ab, d), normal);
  return u >= 0.0 && v >= 0.0 && u + v <= dot(cross(ab, ac), normal);
}

vec3 satisfied(vec3 at, vec3 from, uint k) {
  uvec4 t = triangles[p.first + k];
  vec3 a = vertex[t.x].xyz, ab = vertex[t.y].xyz - a, ac = vertex[t.z].xyz - a;
  vec3 normal = cross(ab, ac), d = at - a;
  float area = length(normal);
  if (!(area > 0.0)) return at;
  normal /= side * area;
  float height = dot(d, normal);
  if (height < p.margin && height > -p.depth && projects_into(d, ab, ac, side * normal))
    return touched(at, from, normal, p.margin - height, p.friction);
  return at;
}
#endif

void main() {
  uint i = item();
  if (i >= p.particles) return;
  vec4 particle = q[i];
  if (particle.w == 0.0) return;
  vec3 from = FRICTION > 0u || PROJECT_PREVIOUS == 1u ? x[i].xyz : vec3(0.0);
  side = OPPOSITE_NORMALS == 1u && i >= p.layer ? -1.0 : 1.0;
  vec3 begin = PROJECT_PREVIOUS == 1u ? from : particle.xyz, at = begin;
  for (uint k = 0u; k < p.count; ++k) at = satisfied(at, from, k);
  if (PROJECT_PREVIOUS == 1u) at = particle.xyz + (at - begin);
  q[i] = vec4(at, particle.w);
  if (FRICTION == 2u) slip[i] = vec4(slip[i].xyz + removed, 0.0);
}

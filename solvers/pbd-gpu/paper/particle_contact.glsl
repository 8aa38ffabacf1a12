// Shared by the collision kernels of `paper`. Bindings: 0 the colliders, 1 predicted positions, 2 positions at the
// step's start, 3 vertices of a mesh.
layout(std430, binding = BIND_PREDICTED) buffer Bdf2 { vec4 q[]; };
layout(std430, binding = BIND_POSITIONS) readonly buffer Positions { vec4 x[]; };
layout(std430, binding = BIND_SLIP) buffer Slip { vec4 slip[]; };  // displacement that velocities leave out
layout(push_constant) uniform Push { PaperContactConstants p; };
PAPER_CONSTANTS(SPECIALIZE)

float side;                // -1: triangles push against their normals
vec3 removed = vec3(0.0);  // tangential displacement that friction takes off the velocity

/// Moves `at` by `push` along `normal`; friction takes its share of the tangential displacement since `from`.
vec3 touched(vec3 at, vec3 from, vec3 normal, float push, float friction) {
  at += push * normal;
  if (FRICTION == 0u) return at;
  vec3 displacement = at - from;
  vec3 taken = min(friction, 1.0) * (displacement - dot(displacement, normal) * normal);
  if (FRICTION == 1u) return at - taken;
  removed += taken;
  return at;
}

/// Out of the ball of radius `reach` round `center`; its very centre has no direction and stays.
vec3 out_of_ball(vec3 at, vec3 from, vec3 center, float reach, float friction) {
  vec3 d = at - center;
  float l = length(d);
  return l < reach && l > 0.0 ? touched(at, from, d / l, reach - l, friction) : at;
}

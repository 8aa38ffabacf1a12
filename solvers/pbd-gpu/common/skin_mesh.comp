#version 450
// Linear blend skinning: x = sum_k w_k M_k rest. Weights of 0 are not skipped, so every vertex reads the same number of
// bytes. KEEP_START: also stores the vertex's position at the frame's start.
#include "common/common.glsl"
layout(std430, binding = BIND_SKIN) readonly buffer Skin { SkinVertex skin[]; };
layout(std430, binding = BIND_JOINTS) readonly buffer Joints { JointMatrix joints[]; };
#ifdef KEEP_START
layout(std430, binding = BIND_KINEMATIC_END) buffer Positions { vec4 x[]; };
layout(std430, binding = BIND_KINEMATIC_START) writeonly buffer StartPositions { vec4 x0[]; };
#else
layout(std430, binding = BIND_KINEMATIC_END) writeonly buffer Positions { vec4 x[]; };
#endif
layout(push_constant) uniform Push { SkinConstants p; };

vec3 moved(JointMatrix m, vec3 at) {
  return vec3(dot(m.row0.xyz, at) + m.row0.w, dot(m.row1.xyz, at) + m.row1.w, dot(m.row2.xyz, at) + m.row2.w);
}

void main() {
  uint i = item();
  if (i >= p.vertices) return;
  SkinVertex v = skin[i];
  vec3 at = v.weights.x * moved(joints[v.joints.x], v.rest.xyz);
  at += v.weights.y * moved(joints[v.joints.y], v.rest.xyz);
  at += v.weights.z * moved(joints[v.joints.z], v.rest.xyz);
  at += v.weights.w * moved(joints[v.joints.w], v.rest.xyz);
#ifdef KEEP_START
  x0[i] = x[i];
#endif
  x[i] = vec4(at, 0.0);
}

#version 450
// Start of a frame: where the points of moving pieces are at its start and end.
#extension GL_GOOGLE_include_directive : require
#include "common.glsl"
layout(std430, binding = BIND_POINT_SOURCES) readonly buffer Sources { PointSource sources[]; };
layout(std430, binding = BIND_CAPSULES) readonly buffer Capsules { CapsuleShape capsules[]; };
layout(std430, binding = BIND_MOVING_START) readonly buffer MovingStart { vec4 moving_start[]; };
layout(std430, binding = BIND_MOVING_END) readonly buffer MovingEnd { vec4 moving_end[]; };
layout(std430, binding = BIND_POINTS) writeonly buffer Points { PiecePoint points[]; };
layout(push_constant) uniform Push { PlaneContactConstants p; };

void main() {
  uint k = item();
  if (k >= p.count) return;
  PointSource s = LOAD(16u, sources, k);
  PiecePoint q;
  if (s.capsule == 1u) {
    CapsuleShape c = LOAD(64u, capsules, s.index / 2u);
    bool second = s.index % 2u == 1u;
    q = PiecePoint(second ? c.b0 : c.a0, second ? c.b1 : c.a1);
  } else {
    q = PiecePoint(LOAD16(moving_start, s.index), LOAD16(moving_end, s.index));
  }
  STORE32(points, s.point, q);
}

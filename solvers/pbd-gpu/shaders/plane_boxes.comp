#version 450
// Start of a frame: boxes of pieces, round their ways through the frame and their margins, and of groups of neighbouring pieces.
// low.w: greatest displacement of any of their points.
#extension GL_GOOGLE_include_directive : require
#include "common.glsl"
layout(std430, binding = BIND_PIECES) readonly buffer Pieces { ContactPiece pieces[]; };
layout(std430, binding = BIND_POINTS) readonly buffer Points { PiecePoint points[]; };
layout(std430, binding = BIND_PIECE_BOXES) buffer PieceBoxes { ClusterBox boxes[]; };
layout(push_constant) uniform Push { PlaneContactConstants p; };

ClusterBox box_of(uint k) {
  ContactPiece piece = LOAD(32u, pieces, k);
  if (piece.moves == 0u) return LOAD(32u, boxes, k);
  vec3 low = vec3(1e30), high = vec3(-1e30);
  float way = 0.0;
  for (uint j = 0u; j < piece.count; ++j) {
    PiecePoint q = LOAD(32u, points, piece.first + j);
    low = min(low, min(q.start.xyz, q.end.xyz));
    high = max(high, max(q.start.xyz, q.end.xyz));
    way = max(way, distance(q.start.xyz, q.end.xyz));
  }
  float more = piece.radius + piece.margin;
  return ClusterBox(vec4(low - more, way), vec4(high + more, 0.0));
}

void main() {
  uint g = item();
  if (g >= p.groups) return;
  ClusterBox all = ClusterBox(vec4(1e30, 1e30, 1e30, 0.0), vec4(-1e30));
  for (uint k = PIECES_A_GROUP * g; k < min(PIECES_A_GROUP * (g + 1u), p.pieces); ++k) {
    ClusterBox box = box_of(k);
    STORE32(boxes, k, box);
    all.low = vec4(min(all.low.xyz, box.low.xyz), max(all.low.w, box.low.w));
    all.high.xyz = max(all.high.xyz, box.high.xyz);
  }
  STORE32(boxes, p.pieces + g, all);
}

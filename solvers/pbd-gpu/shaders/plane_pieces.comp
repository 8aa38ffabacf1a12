#version 450
// Start of a frame, a workgroup a group of neighbouring pieces: where the points of those that move are at its start and end, their
// boxes round their ways, radii and margins, and the group's box. low.w: greatest displacement of any of their points.
#include "common.glsl"
#include "box_bits.glsl"
layout(std430, binding = BIND_POINT_SOURCES) readonly buffer Sources { PointSource sources[]; };
layout(std430, binding = BIND_CAPSULES) readonly buffer Capsules { CapsuleShape capsules[]; };
layout(std430, binding = BIND_MOVING_START) readonly buffer MovingStart { vec4 moving_start[]; };
layout(std430, binding = BIND_MOVING_END) readonly buffer MovingEnd { vec4 moving_end[]; };
layout(std430, binding = BIND_PIECES) readonly buffer Pieces { ContactPiece pieces[]; };
layout(std430, binding = BIND_POINTS) writeonly buffer Points { PiecePoint points[]; };
layout(std430, binding = BIND_PIECE_BOXES) buffer PieceBoxes { PieceBox boxes[]; };
layout(push_constant) uniform Push { PlaneContactConstants p; };

shared uint lows[3u * PIECES_A_GROUP], highs[3u * PIECES_A_GROUP], displacements[PIECES_A_GROUP];

PiecePoint point_of(PointSource s) {
  if (s.capsule == 0u) return PiecePoint(LOAD16(moving_start, s.index), LOAD16(moving_end, s.index));
  CapsuleShape c = LOAD(64u, capsules, s.index / 2u);
  return s.index % 2u == 1u ? PiecePoint(c.b0, c.b1) : PiecePoint(c.a0, c.a1);
}

PieceBox box_of(uint k, uint t) {
  ContactPiece piece = LOAD(32u, pieces, k);
  if (piece.moves == 0u) return LOAD(32u, boxes, k);
  float more = piece.radius + piece.margin;
  PieceBox b = PieceBox(vec4(0.0, 0.0, 0.0, uintBitsToFloat(displacements[t])), vec4(0.0));
  for (uint c = 0u; c < 3u; ++c) {
    b.low[c] = of_ordered(lows[3u * t + c]) - more;
    b.high[c] = of_ordered(highs[3u * t + c]) + more;
  }
  return b;
}

void main() {
  uint group = gl_WorkGroupID.y * gl_NumWorkGroups.x + gl_WorkGroupID.x, t = gl_LocalInvocationIndex;
  if (group >= p.groups) return;
  uint first = PIECES_A_GROUP * group, n = min(PIECES_A_GROUP, p.pieces - first);
  if (t < PIECES_A_GROUP) {
    displacements[t] = 0u;
    for (uint c = 0u; c < 3u; ++c) {
      lows[3u * t + c] = kLowNone;
      highs[3u * t + c] = kHighNone;
    }
  }
  barrier();  // empty boxes before they are widened
  ContactPiece last = LOAD(32u, pieces, first + n - 1u);
  uint begin = LOAD(32u, pieces, first).first_source, end = last.first_source + (last.moves != 0u ? last.count : 0u);
  for (uint k = begin + t; k < end; k += gl_WorkGroupSize.x) {
    PointSource s = LOAD(16u, sources, k);
    PiecePoint q = point_of(s);
    STORE32(points, s.point, q);
    uint o = s.piece - first;
    for (uint c = 0u; c < 3u; ++c) {
      atomicMin(lows[3u * o + c], ordered(min(q.start[c], q.end[c])));
      atomicMax(highs[3u * o + c], ordered(max(q.start[c], q.end[c])));
    }
    atomicMax(displacements[o], floatBitsToUint(distance(q.start.xyz, q.end.xyz)));
  }
  barrier();  // boxes of points before those of pieces
  PieceBox b = PieceBox(vec4(1e30, 1e30, 1e30, 0.0), vec4(-1e30));
  if (t < n) {
    b = box_of(first + t, t);
    STORE32(boxes, first + t, b);
  }
  barrier();  // reads of the points' boxes before they hold the pieces'
  if (t < n) {
    displacements[t] = floatBitsToUint(b.low.w);
    for (uint c = 0u; c < 3u; ++c) {
      lows[3u * t + c] = ordered(b.low[c]);
      highs[3u * t + c] = ordered(b.high[c]);
    }
  }
  barrier();  // boxes of pieces before the group's
  if (t != 0u) return;
  for (uint o = 1u; o < n; ++o) {
    b.low.w = max(b.low.w, uintBitsToFloat(displacements[o]));
    for (uint c = 0u; c < 3u; ++c) {
      b.low[c] = min(b.low[c], of_ordered(lows[3u * o + c]));
      b.high[c] = max(b.high[c], of_ordered(highs[3u * o + c]));
    }
  }
  STORE32(boxes, p.pieces + group, b);
}

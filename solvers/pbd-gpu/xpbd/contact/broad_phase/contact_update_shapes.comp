#version 450
// Start of a frame, one workgroup per group of neighbouring convex shapes: where the points of those that move are at
// its start and end, their boxes around their displacements, radii and margins, and the group's box. low.w: maximum
// displacement of any of their points.
#include "common/common.glsl"
#include "xpbd/contact/broad_phase/atomic_aabb.glsl"
layout(std430, binding = BIND_POINT_SOURCES) readonly buffer Sources { PointSource sources[]; };
layout(std430, binding = BIND_CAPSULES) readonly buffer Capsules { CapsuleShape capsules[]; };
layout(std430, binding = BIND_KINEMATIC_START) readonly buffer KinematicStart { vec4 kinematic_start[]; };
layout(std430, binding = BIND_KINEMATIC_END) readonly buffer KinematicEnd { vec4 kinematic_end[]; };
layout(std430, binding = BIND_SHAPES) readonly buffer ConvexShapeBuffer { ConvexShape shapes[]; };
layout(std430, binding = BIND_POINTS) writeonly buffer Points { ShapePoint points[]; };
layout(std430, binding = BIND_SHAPE_AABBS) buffer ShapeAabbs { ShapeAabb boxes[]; };
CONTACT_CONSTANTS(SPECIALIZE)

shared uint lows[3u * SHAPES_PER_GROUP], highs[3u * SHAPES_PER_GROUP], displacements[SHAPES_PER_GROUP];

ShapePoint point_of(PointSource s) {
  if (s.capsule == 0u) return ShapePoint(kinematic_start[s.index], kinematic_end[s.index]);
  CapsuleShape c = capsules[s.index / 2u];
  return s.index % 2u == 1u ? ShapePoint(c.b0, c.b1) : ShapePoint(c.a0, c.a1);
}

ShapeAabb box_of(uint k, uint t) {
  ConvexShape shape = shapes[k];
  if (shape.is_kinematic == 0u) return boxes[k];
  float more = shape.radius + shape.margin;
  ShapeAabb b = ShapeAabb(vec4(0.0, 0.0, 0.0, uintBitsToFloat(displacements[t])), vec4(0.0));
  for (uint c = 0u; c < 3u; ++c) {
    b.low[c] = of_ordered(lows[3u * t + c]) - more;
    b.high[c] = of_ordered(highs[3u * t + c]) + more;
  }
  return b;
}

void main() {
  uint group = gl_WorkGroupID.y * gl_NumWorkGroups.x + gl_WorkGroupID.x, t = gl_LocalInvocationIndex;
  if (group >= GROUPS) return;
  uint first = SHAPES_PER_GROUP * group, n = min(SHAPES_PER_GROUP, SHAPES - first);
  if (t < SHAPES_PER_GROUP) {
    displacements[t] = 0u;
    for (uint c = 0u; c < 3u; ++c) {
      lows[3u * t + c] = kLowNone;
      highs[3u * t + c] = kHighNone;
    }
  }
  barrier();  // empty boxes before they are widened
  ConvexShape last = shapes[first + n - 1u];
  uint begin = shapes[first].first_source, end = last.first_source + (last.is_kinematic != 0u ? last.count : 0u);
  for (uint k = begin + t; k < end; k += gl_WorkGroupSize.x) {
    PointSource s = sources[k];
    ShapePoint q = point_of(s);
    points[s.point] = q;
    uint o = s.shape - first;
    for (uint c = 0u; c < 3u; ++c) {
      atomicMin(lows[3u * o + c], ordered(min(q.start[c], q.end[c])));
      atomicMax(highs[3u * o + c], ordered(max(q.start[c], q.end[c])));
    }
    atomicMax(displacements[o], floatBitsToUint(distance(q.start.xyz, q.end.xyz)));
  }
  barrier();  // wait for boxes of points before making boxes of convex shapes
  ShapeAabb b = ShapeAabb(vec4(1e30, 1e30, 1e30, 0.0), vec4(-1e30));
  if (t < n) {
    b = box_of(first + t, t);
    boxes[first + t] = b;
  }
  barrier();  // reads of the points' boxes before they hold the convex shapes'
  if (t < n) {
    displacements[t] = floatBitsToUint(b.low.w);
    for (uint c = 0u; c < 3u; ++c) {
      lows[3u * t + c] = ordered(b.low[c]);
      highs[3u * t + c] = ordered(b.high[c]);
    }
  }
  barrier();  // boxes of convex shapes before the group's
  if (t != 0u) return;
  for (uint o = 1u; o < n; ++o) {
    b.low.w = max(b.low.w, uintBitsToFloat(displacements[o]));
    for (uint c = 0u; c < 3u; ++c) {
      b.low[c] = min(b.low[c], of_ordered(lows[3u * o + c]));
      b.high[c] = max(b.high[c], of_ordered(highs[3u * o + c]));
    }
  }
  boxes[SHAPES + group] = b;
}

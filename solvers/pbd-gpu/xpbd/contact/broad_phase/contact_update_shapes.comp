#version 450
// Once per frame, one workgroup per group of neighbouring convex shapes. Stores the points of kinematic shapes at the
// frame's start and end, the box that contains each shape throughout the frame, inflated by radius and margin, and the
// group's box. low.w: maximum displacement of a point.
#include "common/common.glsl"
layout(std430, binding = BIND_POINT_SOURCES) readonly buffer Sources { PointSource sources[]; };
layout(std430, binding = BIND_CAPSULES) readonly buffer Capsules { CapsuleShape capsules[]; };
layout(std430, binding = BIND_KINEMATIC_START) readonly buffer KinematicStart { vec4 kinematic_start[]; };
layout(std430, binding = BIND_KINEMATIC_END) readonly buffer KinematicEnd { vec4 kinematic_end[]; };
layout(std430, binding = BIND_SHAPES) readonly buffer ConvexShapeBuffer { ConvexShape shapes[]; };
layout(std430, binding = BIND_POINTS) writeonly buffer Points { ShapePoint points[]; };
layout(std430, binding = BIND_SHAPE_AABBS) buffer ShapeAabbs { ShapeAabb boxes[]; };
CONTACT_CONSTANTS(SPECIALIZE)

shared vec4 lows[SHAPES_PER_GROUP], highs[SHAPES_PER_GROUP];

ShapePoint point_of(PointSource s) {
  if (s.capsule == 0u) return ShapePoint(kinematic_start[s.index], kinematic_end[s.index]);
  CapsuleShape c = capsules[s.index / 2u];
  return s.index % 2u == 1u ? ShapePoint(c.b0, c.b1) : ShapePoint(c.a0, c.a1);
}

ShapeAabb box_of(uint k) {
  ConvexShape shape = shapes[k];
  if (shape.is_kinematic == 0u) return boxes[k];
  ShapeAabb b = ShapeAabb(vec4(vec3(1e30), 0.0), vec4(-1e30));
  for (uint j = shape.first_source; j < shape.first_source + shape.count; ++j) {
    ShapePoint q = point_of(sources[j]);
    b.low = vec4(min(b.low.xyz, min(q.start.xyz, q.end.xyz)), max(b.low.w, distance(q.start.xyz, q.end.xyz)));
    b.high = max(b.high, max(q.start, q.end));
  }
  b.low.xyz -= shape.radius + shape.margin;
  b.high.xyz += shape.radius + shape.margin;
  return b;
}

void main() {
  uint group = gl_WorkGroupID.y * gl_NumWorkGroups.x + gl_WorkGroupID.x, t = gl_LocalInvocationIndex;
  if (group >= GROUPS) return;
  uint first = SHAPES_PER_GROUP * group, n = min(SHAPES_PER_GROUP, SHAPES - first);
  ConvexShape last = shapes[first + n - 1u];
  uint begin = shapes[first].first_source, end = last.first_source + (last.is_kinematic != 0u ? last.count : 0u);
  for (uint k = begin + t; k < end; k += gl_WorkGroupSize.x) points[sources[k].point] = point_of(sources[k]);
  if (t < n) {
    ShapeAabb b = box_of(first + t);
    boxes[first + t] = b;
    lows[t] = b.low;
    highs[t] = b.high;
  }
  barrier();  // wait for the boxes of shapes before thread 0 makes the group's box
  if (t != 0u) return;
  ShapeAabb all = ShapeAabb(lows[0], highs[0]);
  for (uint o = 1u; o < n; ++o) {
    all.low = vec4(min(all.low.xyz, lows[o].xyz), max(all.low.w, lows[o].w));
    all.high = max(all.high, highs[o]);
  }
  boxes[SHAPES + group] = all;
}

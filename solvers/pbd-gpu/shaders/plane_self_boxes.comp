#version 450
// Start of a frame, a thread a triangle: boxes of the triangles at rest (share 0) and grown by their vertices'
// reaches (share 1), each by half of the thickness, and the group's at share 1.
#include "common.glsl"
#include "plane_buffers.glsl"
layout(std430, binding = BIND_REACHES) readonly buffer Reaches { vec4 reaches[]; };
layout(std430, binding = BIND_SELF_ORDER) readonly buffer SelfOrder { uint self_order[]; };
layout(std430, binding = BIND_SELF_BOXES) writeonly buffer SelfBoxes { SelfBox self_boxes[]; };
#include "plane_self_boxes.glsl"

void main() { write_boxes(item()); }

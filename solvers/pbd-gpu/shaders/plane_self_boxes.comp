#version 450
// Start of a frame, a thread a triangle: boxes of the triangles at rest (share 0) and grown by their vertices'
// reaches (share 1), each by half of the thickness, and the group's at share 1.
#include "common.glsl"
#include "plane_buffers.glsl"
// Boxes of triangles and of groups of them, for the list of the cloth's pairs with itself. Groups are 16 triangles in self_order, which
// keeps neighbours together.
#include "self_box.glsl"
#include "box_bits.glsl"
const uint kGroups = gl_WorkGroupSize.x / PIECES_A_GROUP;
shared uint group_low[3u * kGroups], group_high[3u * kGroups];

SelfBox box_of(uvec4 e) {
  SelfBox box = SelfBox(vec4(1e30), vec4(-1e30), vec4(1e30), vec4(-1e30));
  float half_m = 0.5 * THICKNESS_M;
  [[unroll]] for (uint c = 0u; c < 3u; ++c) {
    vec4 r = LOAD16(reaches, e[c]);
    box.low_0.xyz = min(box.low_0.xyz, r.xyz - half_m);
    box.high_0.xyz = max(box.high_0.xyz, r.xyz + half_m);
    box.low_1.xyz = min(box.low_1.xyz, r.xyz - (half_m + r.w));
    box.high_1.xyz = max(box.high_1.xyz, r.xyz + (half_m + r.w));
  }
  return box;
}

/// Of triangle `q` in self_order, by a thread; all threads of a workgroup come along.
void write_boxes(uint q) {
  uint thread = gl_LocalInvocationIndex, group = thread / PIECES_A_GROUP;
  for (uint n = thread; n < 3u * kGroups; n += gl_WorkGroupSize.x) {
    group_low[n] = kLowNone;
    group_high[n] = kHighNone;
  }
  barrier();  // empty boxes before they are widened
  if (q < TRIANGLES) {
    SelfBox box = box_of(LOAD16(elements, LOAD4(self_order, q)));
    STORE64(self_boxes, q, box);
    vec3 low = low_at(box, 1.0), high = high_at(box, 1.0);
    for (uint c = 0u; c < 3u; ++c) {
      atomicMin(group_low[3u * group + c], ordered(low[c]));
      atomicMax(group_high[3u * group + c], ordered(high[c]));
    }
  }
  barrier();  // the groups' boxes before they are written
  if (q >= TRIANGLES || q % PIECES_A_GROUP != 0u) return;
  SelfBox of_group;
  for (uint c = 0u; c < 3u; ++c) {
    of_group.low_0[c] = of_ordered(group_low[3u * group + c]);
    of_group.high_0[c] = of_ordered(group_high[3u * group + c]);
  }
  of_group.low_0.w = 1e30;
  of_group.high_0.w = -1e30;
  of_group.low_1 = of_group.low_0;  // so that rounding does not part it from a triangle of its own
  of_group.high_1 = of_group.high_0;
  STORE64(self_boxes, TRIANGLES + q / PIECES_A_GROUP, of_group);
}

void main() { write_boxes(item()); }

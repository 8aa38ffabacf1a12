// Once per frame, one thread per triangle. A triangle has two boxes: at the frame's start (fraction 0), and inflated by
// its vertices' motion bounds (fraction 1). Both are also inflated by the drift plus half of the thickness. A group is
// TRIANGLES_PER_GROUP successive triangles of self_order, which keeps neighbours together. The group's box contains its
// triangles' boxes at fraction 1.
#include "xpbd/contact/broad_phase/self_aabb.glsl"
#include "xpbd/contact/broad_phase/atomic_aabb.glsl"
const uint kGroups = gl_WorkGroupSize.x / TRIANGLES_PER_GROUP;
shared uint group_low[3u * kGroups], group_high[3u * kGroups];

SelfAabb box_of(uvec4 e) {
  SelfAabb box = SelfAabb(vec4(1e30), vec4(-1e30), vec4(1e30), vec4(-1e30));
  float half_m = 0.5 * THICKNESS_M + drift_m();
  [[unroll]] for (uint c = 0u; c < 3u; ++c) {
    vec4 r = motion_bounds[e[c]];
    box.low_0.xyz = min(box.low_0.xyz, r.xyz - half_m);
    box.high_0.xyz = max(box.high_0.xyz, r.xyz + half_m);
    box.low_1.xyz = min(box.low_1.xyz, r.xyz - (half_m + r.w));
    box.high_1.xyz = max(box.high_1.xyz, r.xyz + (half_m + r.w));
  }
  return box;
}

/// Control flow is workgroup-uniform.
void make_self_aabbs() {
  uint q = item(), thread = gl_LocalInvocationIndex, group = thread / TRIANGLES_PER_GROUP;
  for (uint n = thread; n < 3u * kGroups; n += gl_WorkGroupSize.x) {
    group_low[n] = kLowNone;
    group_high[n] = kHighNone;
  }
  barrier();  // wait for the empty boxes before threads grow them
  if (q < TRIANGLES) {
    SelfAabb box = box_of(primitives[self_order[q]]);
    self_aabbs[q] = box;
    vec3 low = low_at(box, 1.0), high = high_at(box, 1.0);
    for (uint c = 0u; c < 3u; ++c) {
      atomicMin(group_low[3u * group + c], ordered(low[c]));
      atomicMax(group_high[3u * group + c], ordered(high[c]));
    }
  }
  barrier();  // wait for the groups' boxes before threads store them
  if (q >= TRIANGLES || q % TRIANGLES_PER_GROUP != 0u) return;
  SelfAabb of_group;
  for (uint c = 0u; c < 3u; ++c) {
    of_group.low_0[c] = of_ordered(group_low[3u * group + c]);
    of_group.high_0[c] = of_ordered(group_high[3u * group + c]);
  }
  of_group.low_0.w = 1e30;
  of_group.high_0.w = -1e30;
  of_group.low_1 = of_group.low_0;  // low_at() then adds 0: rounding cannot shrink a group's box below its triangles'
  of_group.high_1 = of_group.high_0;
  self_aabbs[TRIANGLES + q / TRIANGLES_PER_GROUP] = of_group;
}

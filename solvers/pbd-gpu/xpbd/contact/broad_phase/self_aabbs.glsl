// Boxes of triangles and vertices for a new list of self-contact pairs, one thread per triangle. A group is
// TRIANGLES_PER_GROUP successive triangles of self_order, which keeps neighbours together. The group's box contains its
// triangles' boxes at both levels.
#include "xpbd/contact/broad_phase/self_aabb.glsl"
#include "xpbd/contact/broad_phase/atomic_aabb.glsl"
const uint kGroups = gl_WorkGroupSize.x / TRIANGLES_PER_GROUP;
shared uint group_low[3u * kGroups], group_high[3u * kGroups];

// A longer list costs more pairs, a shorter one is made more often. A list expires when a vertex leaves its box.
const float kSubstepsAhead = 6.0;  // [substeps] for which a vertex may keep its displacement
const float kSkinOfRoom = 0.25;    // part of ROOM_BESIDE_LAYERS by which boxes are larger
const float kSkinOfDisplacement = 1.0;  // part of the displacement, for vertices that change their velocity

SelfBounds bounds_of(uint i) {
  vec3 from = starts[i].xyz, by = y[i].xyz - from, to = from + (1.0 + kSubstepsAhead) * by;
  float skin = kSkinOfRoom * ROOM_BESIDE_LAYERS + kSkinOfDisplacement * length(by);
  return SelfBounds(vec4(min(from, to) - skin, 0.0), vec4(max(from, to) + skin, 0.0));
}

SelfAabb box_of(uvec4 e) {
  SelfAabb box = SelfAabb(vec4(vec3(1e30), 0.0), vec4(-1e30), vec4(1e30), vec4(-1e30));
  [[unroll]] for (uint c = 0u; c < 3u; ++c) {
    vec4 start = starts[e[c]];
    SelfBounds bounds = bounds_of(e[c]);
    box.low_0 = vec4(min(box.low_0.xyz, start.xyz), max(box.low_0.w, start.w));
    box.high_0.xyz = max(box.high_0.xyz, start.xyz);
    box.low_1.xyz = min(box.low_1.xyz, bounds.low.xyz - ROOM_BESIDE_LAYERS);
    box.high_1.xyz = max(box.high_1.xyz, bounds.high.xyz + ROOM_BESIDE_LAYERS);
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
  for (uint i = q; i < VERTICES; i += stride()) self_bounds[i] = bounds_of(i);
  barrier();  // wait for the empty boxes before threads grow them
  if (q < TRIANGLES) {
    SelfAabb box = box_of(primitives[self_order[q]]);
    self_aabbs[q] = box;
    vec3 low = min(low_at(box, 0u), low_at(box, 1u)), high = max(high_at(box, 0u), high_at(box, 1u));
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
  of_group.low_0.w = of_group.high_0.w = 0.0;
  of_group.low_1 = of_group.low_0;
  uint supergroup = q / TRIANGLES_PER_GROUP / GROUPS_PER_SUPERGROUP;
  for (uint c = 0u; c < 3u; ++c) {
    atomicMin(self_supergroups[supergroup].low[c], group_low[3u * group + c]);
    atomicMax(self_supergroups[supergroup].high[c], group_high[3u * group + c]);
  }
  of_group.high_1 = of_group.high_0;
  self_aabbs[TRIANGLES + q / TRIANGLES_PER_GROUP] = of_group;
}

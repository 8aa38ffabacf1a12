// The box of all positions that the cloth can reach in a frame. It is reduced per thread, per subgroup, per workgroup
// and then over all workgroups, so that few threads wait for one another.
#include "xpbd/contact/broad_phase/atomic_aabb.glsl"
shared uint cloth_low[3], cloth_high[3];

void empty_box() {
  if (thread >= 3u) return;
  cloth_low[thread] = kLowNone;
  cloth_high[thread] = kHighNone;
}

/// Grows the box [from, to] to contain the sphere around bound.xyz of radius bound.w.
void widen(inout uvec3 from, inout uvec3 to, vec4 bound) {
  for (uint c = 0u; c < 3u; ++c) {
    from[c] = min(from[c], ordered(bound[c] - bound.w));
    to[c] = max(to[c], ordered(bound[c] + bound.w));
  }
}

/// Grows the workgroup's box to contain [from, to], the box of a thread's vertices.
void widen_box(uvec3 from, uvec3 to) {
  barrier();  // wait for the boxes of all lanes before they are exchanged
  for (uint n = gl_SubgroupSize >> 1u; n > 0u; n >>= 1u) {
    from = min(from, subgroupShuffleXor(from, n));
    to = max(to, subgroupShuffleXor(to, n));
  }
  if (gl_SubgroupInvocationID != 0u) return;
  for (uint c = 0u; c < 3u; ++c) {
    atomicMin(cloth_low[c], from[c]);
    atomicMax(cloth_high[c], to[c]);
  }
}

bool overlaps_cloth(ShapeAabb b) {
  for (uint c = 0u; c < 3u; ++c)
    if (CLOTH_LOW[c] > ordered(b.high[c]) || ordered(b.low[c]) > CLOTH_HIGH[c]) return false;
  return true;
}

// The box of everywhere that the cloth may go in a frame: first of a thread's vertices, then of a subgroup, a
// workgroup, all of them, so that few threads wait for one another's sums.
#include "xpbd/contact/broad_phase/atomic_aabb.glsl"
shared uint cloth_low[3], cloth_high[3];

void empty_box() {
  if (thread >= 3u) return;
  cloth_low[thread] = kLowNone;
  cloth_high[thread] = kHighNone;
}

/// By a place and how far from it, in .w.
void widen(inout uvec3 from, inout uvec3 to, vec4 bound) {
  for (uint c = 0u; c < 3u; ++c) {
    from[c] = min(from[c], ordered(bound[c] - bound.w));
    to[c] = max(to[c], ordered(bound[c] + bound.w));
  }
}

/// By the box of a thread's vertices.
void widen_box(uvec3 from, uvec3 to) {
  barrier();  // all lanes have theirs
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

#version 450
// Which blocks may touch which in this substep, a bit each: a list that cannot overflow.
#include "common.glsl"
layout(std430, binding = BIND_BLOCKS) readonly buffer Blocks { vec4 blocks[]; };
layout(std430, binding = BIND_NEAR) writeonly buffer Near { uint near[]; };  // words a block
layout(push_constant) uniform Push { SelfConstants p; };
#include "self.glsl"

void main() {
  uint k = item();
  if (k >= p.blocks * p.words) return;
  uint own = k / p.words, first = 32u * (k % p.words), bits = 0u;
  vec4 low = LOAD16(blocks, 3u * own), high = LOAD16(blocks, 3u * own + 1u), displacement = LOAD16(blocks, 3u * own + 2u);
  for (uint other = first; other < min(first + 32u, p.blocks); ++other) {
    float reach;
    if (concern(low.xyz, high.xyz, displacement.xyz, low.w, LOAD16(blocks, 3u * other), LOAD16(blocks, 3u * other + 1u),
                LOAD16(blocks, 3u * other + 2u), reach))
      bits |= 1u << (other - first);
  }
  STORE4(near, k, bits);
}

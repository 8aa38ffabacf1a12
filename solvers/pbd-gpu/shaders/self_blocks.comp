#version 450
// Before pieces look for each other: of every block of vertices, and of the edges and triangles that begin with them, the
// box at the substep's start, and the middle and radius of the ways that its vertices would go.
#include "common.glsl"
layout(std430, binding = BIND_STARTS) readonly buffer Starts { vec4 starts[]; };
layout(std430, binding = BIND_POSITIONS) readonly buffer Positions { vec4 x[]; };
layout(std430, binding = BIND_BLOCKS) writeonly buffer Blocks { vec4 blocks[]; };  // three a block
layout(std430, binding = BIND_PART) writeonly buffer Part { uint part[]; };
layout(push_constant) uniform Push { SelfConstants p; };

void main() {
  uint k = item();
  if (k >= p.blocks) return;
  // The whole step is allowed until a block finds a smaller fraction.
  if (k == 0u) STORE4(part, 0, floatBitsToUint(1.0));
  uint column = k % p.block_columns * p.side, row = k / p.block_columns * p.side;
  vec3 low = vec3(1e30), high = vec3(-1e30), least = vec3(1e30), most = vec3(-1e30);
  for (uint r = row; r <= min(row + p.side, p.rows - 1u); ++r)
    for (uint c = column; c <= min(column + p.side, p.columns - 1u); ++c) {
      vec3 from = LOAD16(starts, r * p.columns + c).xyz, displacement = LOAD16(x, r * p.columns + c).xyz - from;
      low = min(low, from);
      high = max(high, from);
      least = min(least, displacement);
      most = max(most, displacement);
    }
  STORE16(blocks, 3u * k, vec4(low, 0.5 * distance(least, most)));
  STORE16(blocks, 3u * k + 1u, vec4(high, 0.0));
  STORE16(blocks, 3u * k + 2u, vec4(0.5 * (least + most), 0.0));
}

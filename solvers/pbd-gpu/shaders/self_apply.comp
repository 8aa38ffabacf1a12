#version 450
// Every vertex takes the mean of what it, its triangles and its edges correction, weighted by how much each asks, in a fixed order.
#include "common.glsl"
layout(std430, binding = BIND_POSITIONS) buffer Positions { vec4 x[]; };
layout(std430, binding = BIND_VELOCITIES) buffer Velocities { vec4 v[]; };
layout(std430, binding = BIND_PROPOSED) readonly buffer Corrections { vec4 corrections[]; };
layout(push_constant) uniform Push { SelfConstants p; };

vec4 displacement, gain;

void gather(uint slot) {
  displacement += LOAD16(corrections, 2u * slot);
  gain += LOAD16(corrections, 2u * slot + 1u);
}

void main() {
  uint i = item(), n = p.columns * p.rows;
  if (i >= n) return;
  vec4 at = LOAD16(x, i);
  if (at.w == 0.0) return;
  uint column = i % p.columns, row = i / p.columns, above = i - p.columns;
  bool right = column + 1u < p.columns, left = column > 0u, down = row + 1u < p.rows, up = row > 0u;
  displacement = gain = vec4(0.0);
  gather(i);
  // Triangles: (i, right, both), (i, both, down); edges: to the right, down, both.
  uint t = n, e = 7u * n;
  if (right && down) {
    gather(t + 3u * i);
    gather(t + 3u * (n + i));
    gather(e + 2u * (2u * n + i));
  }
  if (left && down) gather(t + 3u * (i - 1u) + 1u);
  if (left && up) {
    gather(t + 3u * (above - 1u) + 2u);
    gather(t + 3u * (n + above - 1u) + 1u);
    gather(e + 2u * (2u * n + above - 1u) + 1u);
  }
  if (right && up) gather(t + 3u * (n + above) + 2u);
  if (right) gather(e + 2u * i);
  if (left) gather(e + 2u * (i - 1u) + 1u);
  if (down) gather(e + 2u * (n + i));
  if (up) gather(e + 2u * (n + above) + 1u);
  vec3 moved = displacement.w > 0.0 ? displacement.xyz / displacement.w : vec3(0.0);
  STORE16(x, i, vec4(at.xyz + moved * min(1.0, p.most_m / max(length(moved), 1e-30)), at.w));
  vec4 velocity = LOAD16(v, i);
  if (gain.w > 0.0) velocity.xyz += gain.xyz / gain.w;
  STORE16(v, i, velocity);
}

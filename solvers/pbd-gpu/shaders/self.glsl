// Two pieces of the cloth that share no vertex, a vertex and a triangle or two edges, in one substep. Included after the push
// constants `p` are there.

// Contact begins this share of the thickness outside it, or layers at rest would fall back every other substep.
const float kSlack = 0.05;
// Of the distance that layers lack, what one substep gives back.
const float kPush = 0.5;
// A certified displacement leaves this share of the distance at the substep's start, and more of it where it is below a share of the
// thickness: each substep leaves corrections time to push them apart again.
const float kLeft = 0.1, kLeftNear = 0.5, kNear = 0.1;
// Nothing comes nearer than this share of the thickness by its own displacement: before that, everything stops.
const float kLast = 1e-3;
// Nearer than this share of the thickness there is no direction left that float32 could tell.
const float kTouching = 1e-4;

#include "triangle.glsl"

/// How far along ab and cd their nearest points are (Ericson, Real-Time Collision Detection, 5.1.9).
vec2 on_edges(vec3 a, vec3 b, vec3 c, vec3 d) {
  vec3 u = b - a, v = d - c, r = a - c;
  float uu = dot(u, u), vv = dot(v, v), uv = dot(u, v), ur = dot(u, r), vr = dot(v, r);
  // By cross products: uu vv - uv uv would lose its digits where edges are nearly parallel, as those of layers are.
  vec3 across = cross(u, v);
  float area = dot(across, across);
  float s = area > 1e-12 * uu * vv ? clamp(-dot(across, cross(r, v)) / area, 0.0, 1.0) : 0.5;
  float t = vv > 0.0 ? (uv * s + vr) / vv : 0.0;
  if (t < 0.0 || t > 1.0) {
    t = clamp(t, 0.0, 1.0);
    s = uu > 0.0 ? clamp((uv * t - ur) / uu, 0.0, 1.0) : 0.0;
  }
  return vec2(s, t);
}

/// Signed weights of the vector from the nearest point of one piece to that of the other: of a vertex (first) and a triangle, or of
/// two edges. `inside`: the nearest points are inside both edges, so that no vertex is nearer.
vec4 weights_of(bool edges, vec3 q[4], out bool inside) {
  inside = true;
  if (!edges) return vec4(1.0, -on_triangle(q[0], q[1], q[2], q[3]));
  vec2 t = on_edges(q[0], q[1], q[2], q[3]);
  inside = t.x > 0.0 && t.x < 1.0 && t.y > 0.0 && t.y < 1.0;
  return vec4(1.0 - t.x, t.x, t.y - 1.0, -t.y);
}

vec3 weighted(vec4 w, vec3 q[4]) { return w.x * q[0] + w.y * q[1] + w.z * q[2] + w.w * q[3]; }

/// Width of the gap between the two pieces across n: above 0, a plane separates them.
float gap_along(bool edges, vec3 n, vec3 q[4]) {
  float a = dot(n, q[0]), b = dot(n, q[1]), c = dot(n, q[2]), d = dot(n, q[3]);
  return edges ? min(a, b) - max(c, d) : a - max(b, max(c, d));
}

/// Boxes of two blocks (low, w: radius of the ways round their middle; high; middle of the ways), one narrowed to a piece of it.
bool concern(vec3 low, vec3 high, vec3 displacement, float radius, vec4 other_low, vec4 other_high, vec4 other_displacement, out float reach) {
  vec3 apart = max(max(low - other_high.xyz, other_low.xyz - high), 0.0);
  reach = p.reach_m + (distance(displacement, other_displacement.xyz) + radius + other_low.w) / (1.0 - kLeft);
  return !(dot(apart, apart) > reach * reach);
}

/// Whether vertex i is the first of an edge of a family (to the right, down, both), or of a triangle.
bool first_of(uint family, uint i) {
  return (family == 1u || i % p.columns + 1u < p.columns) && (family == 0u || i / p.columns + 1u < p.rows);
}

uint end_of(uint family, uint i) { return i + (family != 1u ? 1u : 0u) + (family != 0u ? p.columns : 0u); }

uvec3 corners_of(uint half_cell, uint i) {
  return half_cell == 0u ? uvec3(i, i + 1u, i + p.columns + 1u) : uvec3(i, i + p.columns + 1u, i + p.columns);
}

uint block_of(uint i) { return i / p.columns / p.side * p.block_columns + i % p.columns / p.side; }

/// First vertex of a block, and how many columns and rows of them it has.
uvec3 vertices_of(uint block) {
  uint column = block % p.block_columns * p.side, row = block / p.block_columns * p.side;
  return uvec3(row * p.columns + column, min(p.side, p.columns - column), min(p.side, p.rows - row));
}

// Nearest points of a primitive of the cloth (a triangle or a vertex) and a convex shape. Every distance used is the
// gap along a direction, computed from all points: a lower bound of the distance, however the direction was rounded,
// and equal to it for the best direction. Coordinates are relative to a point near the primitive.
vec3 cloth[3];     // the primitive's vertices
uint corners;      // their number: 1 or 3
vec3 shape_points[3];  // the shape's points, if at most three
ConvexShape shape;
vec3 around;       // origin of these coordinates

struct Nearest {
  vec3 n;    // from the convex shape to the cloth
  float gap; // between the primitive and the convex shape without its radius; at most 0: they touch
  vec3 on_cloth, on_shape;  // weights of the nearest points; of the shape's only if it has at most three points
  vec3 displacement;  // of the convex shape's nearest point in the substep
};

vec3 point_at(uint j, float t) {
  ShapePoint q = points[shape.first + j];
  // Exact at both ends of the frame, and for static shapes.
  return (t == 1.0 ? q.end.xyz : q.start.xyz + t * (q.end.xyz - q.start.xyz)) - around;
}

// If convex shapes have many points, a fused frame processes each active pair with a subgroup: its lanes divide the
// points among themselves, and all lanes get the same result. One lane writes it.
#ifdef FUSED_FRAME
const bool kPairsOfSubgroups = MAX_POINTS > 3u;
bool by_subgroup = false;  // whether a subgroup processes the current pair
bool writes_pair() { return !by_subgroup || gl_SubgroupInvocationID == 0u; }
float highest_of_subgroup(vec3 n, float t) {
  float high = -1e30;
  for (uint j = gl_SubgroupInvocationID; j < shape.count; j += gl_SubgroupSize)
    high = max(high, dot(n, point_at(j, t)));
  for (uint k = gl_SubgroupSize >> 1u; k > 0u; k >>= 1u) high = max(high, subgroupShuffleXor(high, k));
  return high;
}
#else
const bool kPairsOfSubgroups = false, by_subgroup = false;
bool writes_pair() { return true; }
float highest_of_subgroup(vec3 n, float t) { return 0.0; }
#endif

// Points are read a few at a time: the loads are issued together.
const uint kPointUnroll = MAX_POINTS < 4u ? MAX_POINTS : 4u;

/// max n·(points of the convex shape) at time t, a fraction of the frame.
float highest_point(vec3 n, float t) {
  if (by_subgroup) return highest_of_subgroup(n, t);
  float high = -1e30;
  for (uint first = 0u; first < shape.count; first += kPointUnroll)
    [[unroll]] for (uint k = 0u; k < kPointUnroll; ++k)
      high = max(high, dot(n, point_at(min(first + k, shape.count - 1u), t)));
  return high;
}

/// Gap along n between points of the cloth and the convex shape at time t.
float gap_along(vec3 n, vec3 a, vec3 b, vec3 c, float t) {
  return min(dot(n, a), min(dot(n, b), dot(n, c))) - highest_point(n, t);
}
float gap_now(vec3 n, float t) { return gap_along(n, cloth[0], cloth[1], cloth[2], t); }

/// Replaces the best direction by n if the gap along n is larger.
void try_normal(inout Nearest best, vec3 n, float t) {
  float l = length(n);
  if (!(l > 0.0)) return;
  n /= l;
  float gap = gap_now(n, t);
  if (!(gap > best.gap)) return;
  best.gap = gap;
  best.n = n;
}

// ---- shapes of at most three points: all pairs of features, in closed form (Ericson 2005, 5.1.5 and 5.1.9)

struct Feature {
  float square;
  vec3 on_cloth, on_shape, apart, normal;  // normal: of the face, or perpendicular to both edges; not normalised
};

void take(inout Feature best, vec3 on_cloth, vec3 on_shape, vec3 normal) {
  vec3 d = on_cloth.x * cloth[0] + on_cloth.y * cloth[1] + on_cloth.z * cloth[2] - on_shape.x * shape_points[0] -
           on_shape.y * shape_points[1] - on_shape.z * shape_points[2];
  float square = dot(d, d);
  if (square < best.square) best = Feature(square, on_cloth, on_shape, d, normal);
}

/// Edge i of the primitive with edge j of the convex shape; a point is an edge without length.
void edges(inout Feature best, uint i, uint j) {
  const uint next_i = (i + 1u) % 3u, next_j = (j + 1u) % 3u;
  bool one_i = corners == 1u, one_j = shape.count == 1u;
  vec3 e = (one_i ? cloth[i] : cloth[next_i]) - cloth[i];
  vec3 f = (one_j ? shape_points[j] : shape_points[next_j]) - shape_points[j];
  vec3 g = cloth[i] - shape_points[j];
  float ee = dot(e, e), ff = dot(f, f), ef = dot(e, f), eg = dot(e, g), fg = dot(f, g), all = ee * ff - ef * ef;
  float s = all > 0.0 ? clamp((ef * fg - ff * eg) / all, 0.0, 1.0) : 0.0;
  float t = ff > 0.0 ? clamp((ef * s + fg) / ff, 0.0, 1.0) : 0.0;
  s = ee > 0.0 ? clamp((ef * t - eg) / ee, 0.0, 1.0) : 0.0;
  vec3 on_cloth = vec3(0.0), on_shape = vec3(0.0);
  on_cloth[i] = one_i ? 1.0 - s + s : 1.0 - s;
  on_shape[j] = one_j ? 1.0 - t + t : 1.0 - t;
  if (!one_i) on_cloth[next_i] = s;
  if (!one_j) on_shape[next_j] = t;
  take(best, on_cloth, on_shape, cross(e, f));
}

/// Weights of the projection of p onto the plane of a triangle; false if outside the triangle, where an edge is nearer.
bool foot(vec3 p, vec3 a, vec3 b, vec3 c, out vec3 weights, out vec3 n) {
  vec3 ab = b - a, ac = c - a, ap = p - a;
  n = cross(ab, ac);
  float all = dot(n, n), wb = dot(cross(ap, ac), n), wc = dot(cross(ab, ap), n);
  if (!(all > 0.0 && wb >= 0.0 && wc >= 0.0 && wb + wc <= all)) return false;
  weights = vec3(all - wb - wc, wb, wc) / all;
  return true;
}

Feature nearest_feature() {
  Feature best = Feature(1e30, vec3(0.0), vec3(0.0), vec3(0.0), vec3(0.0));
  uint sides = shape.count == 3u ? 3u : 1u;
  // Unrolled, so that indices are constants and the arrays stay in registers.
  [[unroll]] for (uint i = 0u; i < 3u; ++i)
    [[unroll]] for (uint j = 0u; j < 3u; ++j)
      if (i < corners && j < sides) edges(best, i, j);
  vec3 weights, n;
  if (corners == 3u)
    [[unroll]] for (uint j = 0u; j < 3u; ++j)
      if (j < shape.count && foot(shape_points[j], cloth[0], cloth[1], cloth[2], weights, n)) {
        vec3 one = vec3(0.0);
        one[j] = 1.0;
        take(best, weights, one, n);
      }
  if (shape.count == 3u)
    [[unroll]] for (uint i = 0u; i < 3u; ++i)
      if (i < corners && foot(cloth[i], shape_points[0], shape_points[1], shape_points[2], weights, n)) {
        vec3 one = vec3(0.0);
        one[i] = 1.0;
        take(best, one, weights, n);
      }
  return best;
}

void load_shape(float t) {
  [[unroll]] for (uint j = 0u; j < 3u; ++j) shape_points[j] = j < shape.count ? point_at(j, t) : vec3(0.0);
}

/// Nearest points of `cloth` and the convex shape at time `begin`. The shape's `displacement` is from `begin` to `end`.
Nearest nearest_of_few(float begin, float end) {
  load_shape(begin);
  Feature f = nearest_feature();
  Nearest r = Nearest(vec3(0.0), -1e30, f.on_cloth, f.on_shape, vec3(0.0));
  try_normal(r, f.apart, begin);
  // The difference of the nearest points loses digits if they nearly touch or the shape is large, and a small error of
  // direction changes the gap at the shape's far corners. The normal of the two features is exact enough.
  try_normal(r, dot(f.normal, f.apart) < 0.0 ? -f.normal : f.normal, begin);
  // Above a face, rounding may make an edge the nearest feature, so the face's normal is tried too.
  if (shape.count == 3u) {
    vec3 face = cross(shape_points[1] - shape_points[0], shape_points[2] - shape_points[0]);
    try_normal(r, dot(face, f.apart) < 0.0 ? -face : face, begin);
  }
  vec3 at_begin = vec3(0.0), at_end = vec3(0.0);
  [[unroll]] for (uint j = 0u; j < 3u; ++j) {
    if (j >= shape.count) continue;
    at_end += f.on_shape[j] * point_at(j, end);
    at_begin += f.on_shape[j] * shape_points[j];
  }
  r.displacement = at_end - at_begin;
  return r;
}
#include "xpbd/contact/narrow_phase/gjk.glsl"

Nearest nearest_at(float begin, float end, vec3 guess) {
  Nearest r;
  if (MAX_POINTS > 3u && shape.count > 3u)
    r = nearest_of_hull(begin, end, guess);
  else
    r = nearest_of_few(begin, end);
  if (!(r.gap > 0.0)) try_normal(r, guess, begin);
  return r;
}

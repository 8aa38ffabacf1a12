#pragma once
#include <algorithm>
#include <array>

#include "metrics/contact/surface.hpp"
#include "metrics/motion_check/body_state.hpp"

namespace clothbench::motion_check {

inline V3 point_of(const Simplex<3>& t, const V3& weights) {
  return weights[0] * t[0] + weights[1] * t[1] + weights[2] * t[2];
}

/// Nearest points of two segments: on the first, on the second (Ericson, Real-Time Collision Detection, 5.1.9).
inline std::array<V3, 2> nearest_of_segments(const V3& a, const V3& b, const V3& c, const V3& d) {
  const V3 u = b - a, v = d - c, w = a - c;
  const double uu = u.squaredNorm(), vv = v.squaredNorm(), uv = u.dot(v), uw = u.dot(w), vw = v.dot(w);
  const auto unit = [](double x) { return std::clamp(x, 0.0, 1.0); };
  const double parallel = uu * vv - uv * uv;
  double s = parallel > 1e-12 * uu * vv ? unit((uv * vw - uw * vv) / parallel) : 0;
  double t = vv > 0 ? unit((uv * s + vw) / vv) : 0;
  s = uu > 0 ? unit((uv * t - uw) / uu) : 0;
  t = vv > 0 ? unit((uv * s + vw) / vv) : 0;
  return {a + s * u, c + t * v};
}

/// Nearest points of a triangle and a segment that do not cross: on the triangle, on the segment.
inline std::array<V3, 2> nearest_of(const Simplex<3>& t, const V3& a, const V3& b) {
  std::array<V3, 2> best = {t[0], a};
  double least = kInfinite;
  const auto keep = [&](const V3& on_triangle, const V3& on_segment) {
    const double d = (on_triangle - on_segment).squaredNorm();
    if (d < least) least = d, best = {on_triangle, on_segment};
  };
  keep(point_of(t, contact::nearest_weights(a, t)), a);
  keep(point_of(t, contact::nearest_weights(b, t)), b);
  for (std::size_t i = 0; i < 3; ++i) {
    const auto [on_edge, on_segment] = nearest_of_segments(t[i], t[(i + 1) % 3], a, b);
    keep(on_edge, on_segment);
  }
  return best;
}

/// Nearest points of two triangles that do not cross: on the first, on the second. Edges of the second outside `box`
/// are left out.
inline std::array<V3, 2> nearest_of_triangles(const Simplex<3>& t, const Simplex<3>& s, const Box& box) {
  double least = kInfinite;
  std::array<V3, 2> best = {t[0], s[0]};
  const auto keep = [&](const V3& on_first, const V3& on_second) {
    const double d = (on_first - on_second).squaredNorm();
    if (d < least) least = d, best = {on_first, on_second};
  };
  for (std::size_t k = 0; k < 3; ++k) {
    keep(t[k], point_of(s, contact::nearest_weights(t[k], s)));
    if (!box.intersects(Box(s[k].cwiseMin(s[(k + 1) % 3]), s[k].cwiseMax(s[(k + 1) % 3])))) continue;
    const auto [on_first, on_second] = nearest_of(t, s[k], s[(k + 1) % 3]);
    keep(on_first, on_second);
  }
  return best;
}

/// The same for a triangle on one side of the plane of `s`, with its vertex that is nearest to the plane: if the foot
/// of this vertex is inside `s`, nothing is nearer.
inline std::array<V3, 2> nearest_to_plane(const Simplex<3>& t, const Simplex<3>& s, std::size_t lowest,
                                          const Box& box) {
  const V3 weights = contact::nearest_weights(t[lowest], s);
  if (weights.minCoeff() > 0) return {t[lowest], point_of(s, weights)};
  return nearest_of_triangles(t, s, box);
}

}  // namespace clothbench::motion_check

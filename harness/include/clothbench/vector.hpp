#pragma once
#include <array>
#include <cmath>
#include <cstddef>

namespace clothbench {

using Vec3 = std::array<double, 3>;

/// Vertex `v` of interleaved coordinates (x, y, z of vertex 0, of vertex 1, …).
template <class Numbers>
Vec3 vertex_at(const Numbers& x, std::size_t v) {
  return {x[3 * v], x[3 * v + 1], x[3 * v + 2]};
}
inline Vec3 scaled(double s, const Vec3& a) { return {s * a[0], s * a[1], s * a[2]}; }
inline Vec3 plus(const Vec3& a, const Vec3& b) { return {a[0] + b[0], a[1] + b[1], a[2] + b[2]}; }
inline Vec3 minus(const Vec3& a, const Vec3& b) { return {a[0] - b[0], a[1] - b[1], a[2] - b[2]}; }
inline double dot(const Vec3& a, const Vec3& b) { return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]; }
inline Vec3 cross(const Vec3& a, const Vec3& b) {
  return {a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]};
}
/// Not std::hypot(x, y, z), which returns 0 for (0, NaN, 0) in libstdc++.
inline double length(const Vec3& a) { return std::sqrt(dot(a, a)); }

/// Maximum of two numbers, or NaN if either is NaN, which std::max could drop.
inline double max_or_nan(double a, double b) { return b <= a || a != a ? a : b; }

}  // namespace clothbench

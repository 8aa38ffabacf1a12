#include "render/camera.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "clothbench/error.hpp"
#include "clothbench/vector.hpp"

namespace clothbench::render {
namespace {

constexpr double kFieldOfView = 28;  // degrees of the picture's height: little perspective, as a photograph from afar

double radians(double degrees) { return degrees * std::numbers::pi / 180; }

/// Towards -z, from these angles to the right and up.
void look(Camera& c, double azimuth, double elevation) {
  c.back = {std::sin(azimuth) * std::cos(elevation), std::sin(elevation), std::cos(azimuth) * std::cos(elevation)};
  c.right = {std::cos(azimuth), 0, -std::sin(azimuth)};
  c.up = cross(c.back, c.right);
}

/// Camera position along one axis of the picture such that every point is within the slope `tangent` on both sides:
/// |x - middle| <= tangent (distance - z), z towards the viewer. Exact: the two outermost lines of slope `tangent` meet
/// there.
struct Stand {
  double middle, distance;
};
Stand stand(std::span<const double> points, const Vec3& axis, const Vec3& back, double tangent) {
  double high = -INFINITY, low = -INFINITY;
  for (std::size_t k = 0; k + 2 < points.size(); k += 3) {
    const Vec3 p = {points[k], points[k + 1], points[k + 2]};
    const double x = dot(p, axis), z = dot(p, back);
    high = std::max(high, x + tangent * z);
    low = std::max(low, -x + tangent * z);
  }
  return {(high - low) / 2, (high + low) / (2 * tangent)};
}

}  // namespace

Mat4 operator*(const Mat4& a, const Mat4& b) {
  Mat4 out{};
  for (std::size_t c = 0; c < 4; ++c)
    for (std::size_t r = 0; r < 4; ++r)
      for (std::size_t k = 0; k < 4; ++k) out[4 * c + r] += a[4 * k + r] * b[4 * c + k];
  return out;
}

Mat4 Camera::view(const Vec3& origin_m) const {
  const Vec3 eye = minus(eye_m, origin_m);
  Mat4 m{};
  const std::array<Vec3, 3> axes = {right, up, back};
  for (std::size_t r = 0; r < 3; ++r) {
    for (std::size_t c = 0; c < 3; ++c) m[4 * c + r] = axes[r][c];
    m[12 + r] = -dot(axes[r], eye);
  }
  m[15] = 1;
  return m;
}

Mat4 Camera::projection() const {
  Mat4 m{};
  m[0] = 1 / tan_half_width;
  m[5] = -1 / tan_half_height;
  m[10] = far_m / (near_m - far_m);
  m[11] = -1;
  m[14] = near_m * far_m / (near_m - far_m);
  return m;
}

Camera frame(std::span<const double> points, double aspect) {
  constexpr double kMargin = 0.04;
  if (points.size() < 3) throw Error("camera: expected at least one point to view");
  Camera c;
  look(c, radians(30), radians(24));
  c.tan_half_height = std::tan(radians(kFieldOfView / 2));
  c.tan_half_width = c.tan_half_height * aspect;
  const double within = 1 - 2 * kMargin;
  const Stand x = stand(points, c.right, c.back, within * c.tan_half_width);
  const Stand y = stand(points, c.up, c.back, within * c.tan_half_height);
  double distance = std::max(x.distance, y.distance), nearest = -INFINITY, furthest = INFINITY;
  for (std::size_t k = 0; k + 2 < points.size(); k += 3) {
    const double z = dot({points[k], points[k + 1], points[k + 2]}, c.back);
    nearest = std::max(nearest, z);
    furthest = std::min(furthest, z);
  }
  // A single point, or a sheet seen edge on: any distance would do.
  const double size = std::max({nearest - furthest, distance - nearest, 1e-9});
  distance = std::max(distance, nearest + 0.05 * size);
  for (std::size_t k = 0; k < 3; ++k) c.eye_m[k] = x.middle * c.right[k] + y.middle * c.up[k] + distance * c.back[k];
  c.near_m = 0.3 * (distance - nearest);
  c.far_m = 4 * (distance - furthest) + size;
  return c;
}

std::array<Camera, 2> eyes(const Vec3& middle_m, double distance_m, double near_m, double far_m) {
  constexpr double kApart_m = 0.063, kWidth = 110, kHeight = 96;
  std::array<Camera, 2> both;
  for (std::size_t k = 0; k < 2; ++k) {
    Camera& c = both[k];
    look(c, 0, 0);
    c.eye_m = {middle_m[0] + (k == 0 ? -0.5 : 0.5) * kApart_m, middle_m[1], middle_m[2] + distance_m};
    c.tan_half_width = std::tan(radians(kWidth / 2));
    c.tan_half_height = std::tan(radians(kHeight / 2));
    c.near_m = near_m;
    c.far_m = far_m;
  }
  return both;
}

}  // namespace clothbench::render

#include "render/camera.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "clothbench/error.hpp"
#include "clothbench/vector.hpp"
#include "render/render_shared.h"
#include "scenario/collider_kinds.hpp"

namespace clothbench::render {
namespace {

constexpr double kFieldOfView = 28;  // degrees over the image's height: little perspective, as from a distance

double radians(double degrees) { return degrees * std::numbers::pi / 180; }

/// Looks towards -z after rotations by these angles to the right and up.
void look(Camera& c, double azimuth, double elevation) {
  c.back = {std::sin(azimuth) * std::cos(elevation), std::sin(elevation), std::cos(azimuth) * std::cos(elevation)};
  c.right = {std::cos(azimuth), 0, -std::sin(azimuth)};
  c.up = cross(c.back, c.right);
}

/// Nearest camera position that sees every point, for one image axis x and the view axis z (towards the viewer):
/// |x - middle| <= tangent (distance - z) for all points. Exact: the two outermost lines of slope `tangent` meet there.
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

constexpr double kGrip_m = 0.012;  // radius of the sphere that marks an attached vertex, for a cloth of 1 m

Vec3 unit_or_zero(const Vec3& v) {
  const double size = length(v);
  return size > 0 ? Vec3{v[0] / size, v[1] / size, v[2] / size} : Vec3{};
}

bool finite(const Vec3& v) { return std::isfinite(v[0]) && std::isfinite(v[1]) && std::isfinite(v[2]); }

/// Two directions perpendicular to an axis.
std::array<Vec3, 2> across(const Vec3& axis) {
  const Vec3 first = unit_or_zero(cross(axis, std::abs(axis[0]) < 0.9 ? Vec3{1, 0, 0} : Vec3{0, 1, 0}));
  return {first, cross(axis, first)};
}

std::uint32_t add_vertex(Surfaces& s, const Vec3& p, const Vec3& n, int look) {
  s.position_m.push_back(p);
  s.normal.push_back(n);
  s.look.push_back(static_cast<std::uint8_t>(look));
  return static_cast<std::uint32_t>(s.position_m.size() - 1);
}

/// Triangles of a capsule as rings from pole to pole; a sphere if a = b.
void add_capsule(Surfaces& s, const Capsule& c, int look) {
  constexpr int kSides = 32, kRings = 10;  // rings per hemisphere
  if (!finite(c.a_m) || !finite(c.b_m) || !(c.radius_m > 0)) return;
  Vec3 axis = unit_or_zero(minus(c.b_m, c.a_m));
  if (dot(axis, axis) == 0) axis = {0, 1, 0};
  const auto [x, y] = across(axis);
  const auto first = static_cast<std::uint32_t>(s.position_m.size());
  for (int ring = 0; ring < 2 * kRings; ++ring) {
    const bool far_end = ring >= kRings;
    const double latitude =
        (static_cast<double>(far_end ? ring - kRings : ring - kRings + 1) / (kRings - 1)) * std::numbers::pi / 2;
    for (int side = 0; side < kSides; ++side) {
      const double turn = 2 * std::numbers::pi * side / kSides;
      const Vec3 n = plus(plus(scaled(std::sin(latitude), axis), scaled(std::cos(latitude) * std::cos(turn), x)),
                          scaled(std::cos(latitude) * std::sin(turn), y));
      add_vertex(s, plus(far_end ? c.b_m : c.a_m, scaled(c.radius_m, n)), n, look);
    }
  }
  for (std::uint32_t ring = 0; ring + 1 < 2 * kRings; ++ring)
    for (std::uint32_t side = 0; side < kSides; ++side) {
      const std::uint32_t a = first + ring * kSides + side, b = first + ring * kSides + (side + 1) % kSides;
      s.triangles.push_back({a, b, b + kSides});
      s.triangles.push_back({a, b + kSides, a + kSides});
    }
}

bool meets(const Bounds& b, const std::array<Vec3, 3>& t) {
  for (std::size_t k = 0; k < 3; ++k) {
    const auto [low, high] = std::minmax({t[0][k], t[1][k], t[2][k]});
    if (!(high >= b.low[k] && low <= b.high[k])) return false;
  }
  return true;
}

/// Hands get smooth normals; other meshes keep sharp edges.
void add_triangles(Surfaces& s, const Collider& c, const ColliderPose& pose, const Bounds& near) {
  const Extent seen{scaled(0.5, plus(near.low, near.high)), near.diagonal() / 2};
  const auto [x, triangles] = kind_of(c).surface(c, pose, seen);
  const auto first = static_cast<std::uint32_t>(s.position_m.size());
  for (std::size_t v = 0; v < x.size(); v += 3)
    add_vertex(s, {x[v], x[v + 1], x[v + 2]}, {}, c.moves() ? LOOK_SMOOTH : LOOK_FLAT);
  for (const auto& t : triangles) {
    const std::array<Vec3, 3> p = {s.position_m[first + t[0]], s.position_m[first + t[1]], s.position_m[first + t[2]]};
    if (!finite(p[0]) || !finite(p[1]) || !finite(p[2])) continue;
    if (c.mesh && !c.moves() && !meets(near, p)) continue;
    const Vec3 normal = cross(minus(p[1], p[0]), minus(p[2], p[0]));
    for (const std::uint32_t v : t) s.normal[first + v] = plus(s.normal[first + v], normal);
    s.triangles.push_back({first + t[0], first + t[1], first + t[2]});
  }
  for (std::size_t v = first; v < s.normal.size(); ++v) s.normal[v] = unit_or_zero(s.normal[v]);
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
  // For a single point, or a sheet seen edge-on, any distance would do.
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

Bounds Bounds::none() { return {{INFINITY, INFINITY, INFINITY}, {-INFINITY, -INFINITY, -INFINITY}}; }

Bounds Bounds::of(std::span<const double> positions_m) {
  Bounds b = none();
  for (std::size_t v = 0; v < positions_m.size() / 3; ++v) b.add(vertex_at(positions_m, v));
  return b;
}

void Bounds::add(const Vec3& p) {
  for (std::size_t k = 0; k < 3; ++k) {
    low[k] = std::min(low[k], p[k]);
    high[k] = std::max(high[k], p[k]);
  }
}

void Bounds::grow(double by_m) {
  for (double& x : low) x -= by_m;
  for (double& x : high) x += by_m;
}

bool Bounds::holds(const Vec3& p) const {
  for (std::size_t k = 0; k < 3; ++k)
    if (!(p[k] >= low[k] && p[k] <= high[k])) return false;
  return true;
}

double Bounds::diagonal() const { return length(minus(high, low)); }

Surfaces surfaces(const Scene& scene, int frame, const Bounds& near) {
  Surfaces s;
  const FrameMotion* motion = scene.motion_after(frame - 1);
  static const ColliderPose kStill;
  for (std::size_t k = 0; k < scene.colliders.size(); ++k) {
    const Collider& c = scene.colliders[k];
    const ColliderPose& pose = motion != nullptr && k < motion->colliders.size() ? motion->colliders[k] : kStill;
    if (kind_of(c).capsules != nullptr)
      for (const Capsule& one : kind_of(c).capsules(c, pose)) add_capsule(s, one, LOOK_SMOOTH);
    else
      add_triangles(s, c, pose, near);
  }
  if (motion == nullptr) return s;
  const double radius = kGrip_m * std::max(scene.cloth.width_m, scene.cloth.height_m);
  for (std::size_t k = 0; k < motion->grip_position_m.size(); ++k)
    if (motion->grip_held[k] != 0)
      add_capsule(s, {motion->grip_position_m[k], motion->grip_position_m[k], radius}, LOOK_MARK);
  return s;
}

}  // namespace clothbench::render

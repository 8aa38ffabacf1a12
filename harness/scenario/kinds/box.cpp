// A static box.
#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include "scenario/collider_kinds.hpp"
#include "scenario/collider_reader.hpp"
#include "scenario/vec3.hpp"

namespace clothbench {
namespace {

void read_box(const nlohmann::json& j, ColliderReader& reader, Collider& c) {
  c.shape = Collider::Shape::Box;
  c.center_m = vec3(j["center_m"]);
  const Vec3 size = vec3(j["size_m"]), turn = vec3(j["rotation_deg"]);
  for (std::size_t k = 0; k < 3; ++k) {
    if (!(size[k] > 0)) reader.refuse("/size_m", "expected three lengths above 0");
    c.half_extent_m[k] = size[k] / 2;
  }
  constexpr double kDegree = std::numbers::pi / 180;
  using Turn = Eigen::AngleAxisd;
  const Eigen::Matrix3d r =
      (Turn(turn[2] * kDegree, Eigen::Vector3d::UnitZ()) * Turn(turn[1] * kDegree, Eigen::Vector3d::UnitY()) *
       Turn(turn[0] * kDegree, Eigen::Vector3d::UnitX()))
          .toRotationMatrix();
  for (int k = 0; k < 3; ++k) c.axes[static_cast<std::size_t>(k)] = to_vec3(assets::Vector(r.col(k)));
}

SurfacePlace nearest_on_box(const Collider& box, const Vec3& p) {
  using V = assets::Vector;
  const V from = V::Map(p.data()) - V::Map(box.center_m.data());
  V at = V::Zero(), out = V::Zero();
  double inside = std::numeric_limits<double>::infinity();
  for (std::size_t k = 0; k < 3; ++k) {
    const V axis = V::Map(box.axes[k].data());
    const double x = axis.dot(from), h = box.half_extent_m[k];
    at += std::clamp(x, -h, h) * axis;
    if (h - std::abs(x) < inside) {
      inside = h - std::abs(x);
      out = (x < 0 ? -1 : 1) * axis;
    }
  }
  if (inside >= 0) return {-inside, to_vec3(out)};
  const double distance = (from - at).norm();
  return {distance, to_vec3(V((from - at) / distance))};
}

ColliderSurface faces_of_box(const Collider& box, const ColliderPose&, const Extent&) {
  // The bits of a corner's index are x, y, z. Each face is two triangles that share its diagonal.
  static const std::vector<std::array<std::uint32_t, 3>> kTriangles = {{0, 4, 6}, {0, 6, 2}, {1, 3, 7}, {1, 7, 5},
                                                                       {0, 1, 5}, {0, 5, 4}, {2, 6, 7}, {2, 7, 3},
                                                                       {0, 2, 3}, {0, 3, 1}, {4, 5, 7}, {4, 7, 6}};
  ColliderSurface out{{}, kTriangles};
  for (unsigned corner = 0; corner < 8; ++corner)
    for (std::size_t k = 0; k < 3; ++k) {
      double x = box.center_m[k];
      for (unsigned a = 0; a < 3; ++a) x += ((corner >> a & 1u) != 0 ? 1 : -1) * box.half_extent_m[a] * box.axes[a][k];
      out.positions.push_back(x);
    }
  return out;
}

}  // namespace

ColliderKind box_kind() {
  ColliderKind k{Collider::Shape::Box, "box", Feature::Box, Feature::Box};
  k.types = {{"box", read_box}};
  k.numbers = {{"center_m", 3, [](Collider& c) { return c.center_m.data(); }},
               {"half_extent_m", 3, [](Collider& c) { return c.half_extent_m.data(); }},
               {"axis_u", 3, [](Collider& c) { return c.axes[0].data(); }},
               {"axis_v", 3, [](Collider& c) { return c.axes[1].data(); }},
               {"axis_w", 3, [](Collider& c) { return c.axes[2].data(); }}};
  k.surface = faces_of_box;
  k.nearest = nearest_on_box;
  k.convex = true;
  return k;
}

}  // namespace clothbench

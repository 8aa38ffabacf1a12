// The half-space behind a point.
#include <cmath>

#include "clothbench/vector.hpp"
#include "scenario/collider_kinds.hpp"
#include "scenario/collider_reader.hpp"
#include "scenario/vec3.hpp"

namespace clothbench {
namespace {

void read_plane(const nlohmann::json& j, ColliderReader& reader, Collider& c) {
  c.shape = Collider::Shape::Plane;
  c.center_m = vec3(j["point_m"]);
  c.normal = reader.unit(j, "normal");
}

SurfacePlace nearest_on_plane(const Collider& c, const Vec3& p) {
  const auto map = [](const Vec3& v) { return assets::Vector::Map(v.data()); };
  return {map(c.normal).dot(map(p) - map(c.center_m)), c.normal};
}

ColliderSurface square_of_plane(const Collider& c, const ColliderPose&, const Extent& seen) {
  static constexpr std::array<std::array<std::uint32_t, 3>, 2> kTriangles = {{{0, 1, 2}, {0, 2, 3}}};
  const Vec3& n = c.normal;
  Vec3 x = cross(n, std::abs(n[0]) < 0.9 ? Vec3{1, 0, 0} : Vec3{0, 1, 0});
  const double across = length(x), away = dot(minus(seen.middle, c.center_m), n);
  for (double& v : x) v /= across;
  const Vec3 y = cross(n, x);
  ColliderSurface out{{}, kTriangles};
  for (int i = 0; i < 4; ++i)
    for (std::size_t k = 0; k < 3; ++k)
      out.positions.push_back(seen.middle[k] - away * n[k] + (i == 1 || i == 2 ? 1 : -1) * seen.reach_m * x[k] +
                              (i >= 2 ? 1 : -1) * seen.reach_m * y[k]);
  return out;
}

}  // namespace

ColliderKind plane_kind() {
  ColliderKind k{Collider::Shape::Plane, "plane", Feature::Plane, Feature::Plane};
  k.types = {{"plane", read_plane}};
  k.numbers = {{"point_m", 3, [](Collider& c) { return c.center_m.data(); }},
               {"normal", 3, [](Collider& c) { return c.normal.data(); }}};
  k.surface = square_of_plane;
  k.nearest = nearest_on_plane;
  k.half_space = k.convex = true;
  return k;
}

}  // namespace clothbench

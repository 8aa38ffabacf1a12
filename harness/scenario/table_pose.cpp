#include "scenario/table_pose.hpp"

#include <algorithm>
#include <cmath>
#include <vector>

#include "clothbench/error.hpp"
#include "scenario/vec3.hpp"

namespace clothbench {
namespace {

using assets::Vector;

/// The part of a polygon with f >= 0, f linear.
template <class F>
std::vector<Vector> clip(const std::vector<Vector>& polygon, F f) {
  std::vector<Vector> out;
  for (std::size_t i = 0; i < polygon.size(); ++i) {
    const Vector &a = polygon[i], &b = polygon[(i + 1) % polygon.size()];
    const double fa = f(a), fb = f(b);
    if (fa >= 0) out.push_back(a);
    if ((fa < 0) != (fb < 0)) out.push_back(a + (b - a) * (fa / (fa - fb)));
  }
  return out;
}

struct Edges {
  Vector middle_of_long, along, across;  ///< a point [m]; two level unit vectors, `across` points off the table
  Vector center;
};

Edges edges_of(const assets::Table& table) {
  const auto c = table.top_corners();
  std::size_t longest = 0;
  const auto side = [&](std::size_t k) { return Vector(c[(k + 1) % 4] - c[k]); };
  if (side(1).norm() > side(0).norm()) longest = 1;
  Edges e;
  e.center = (c[0] + c[1] + c[2] + c[3]) / 4;
  e.middle_of_long = (c[longest] + c[(longest + 1) % 4]) / 2;
  e.along = side(longest);
  e.along.y() = 0;
  e.along.normalize();
  e.across = e.along.cross(Vector::UnitY());
  if (e.across.dot(e.middle_of_long - e.center) < 0) e.across = -e.across;
  return e;
}

}  // namespace

double highest_below(const ColliderMesh& mesh, const Footprint& f) {
  const Vector center = Vector::Map(f.center_m.data());
  double highest = -INFINITY;
  for (const auto& t : mesh.triangles) {
    std::vector<Vector> part;
    for (std::uint32_t v : t) part.push_back(Vector::Map(mesh.positions.data() + 3 * v));
    for (const double sign : {1.0, -1.0})
      for (std::size_t k = 0; k < 2; ++k)
        part = clip(part, [&](const Vector& p) {
          return f.size_m[k] / 2 - sign * (p - center).dot(Vector::Map(f.axes[k].data()));
        });
    for (const Vector& p : part) highest = std::max(highest, p.y());
  }
  return highest;
}

TablePose flat_over(const assets::Table& table, const ColliderMesh& mesh, const Cloth& cloth, double drop_m) {
  const Edges e = edges_of(table);
  const double highest =
      highest_below(mesh, {to_vec3(e.center), {to_vec3(e.along), to_vec3(e.across)}, {cloth.width_m, cloth.height_m}});
  if (!std::isfinite(highest))
    throw Error("/cloth/pose/over_table: expected a part of the table's mesh below the cloth");
  // axis_u x axis_v points down, as for the sheet of the other scenes: u, v = x, z.
  Vector v = e.along.cross(Vector::UnitY());
  return {{e.center.x(), highest + drop_m, e.center.z()}, to_vec3(e.along), to_vec3(v)};
}

TablePose corner_first_over(const assets::Table& table, const Cloth& cloth, double drop_m, double tilt,
                            double inset_m) {
  const Edges e = edges_of(table);
  const Vector rising = std::cos(tilt) * e.along + std::sin(tilt) * Vector::UnitY();
  // The lowest corner is u0v0. The sheet's diagonal from it rises; u and v are at 45 degrees to that diagonal.
  const Vector u = (rising + e.across) / std::sqrt(2.0), v = (rising - e.across) / std::sqrt(2.0);
  const Vector lowest = e.middle_of_long - inset_m * e.across + drop_m * Vector::UnitY();
  return {to_vec3(Vector(lowest + cloth.width_m / 2 * u + cloth.height_m / 2 * v)), to_vec3(u), to_vec3(v)};
}

}  // namespace clothbench

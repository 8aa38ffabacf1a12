#include "plugin/rest_shape.hpp"

#include <algorithm>
#include <limits>
#include <map>
#include <utility>

#include "clothbench_plugin.h"

namespace clothbench::plugin {
namespace {

/// Spring constants [N/m] in the sheet that clothbench_plugin.h describes at ClothbenchEdge.
std::vector<double> springs_of(const Scene& s, EdgeKind kind) {
  std::vector<double> out;
  for (const Edge& e : edges(s.cloth, kind)) {
    const auto Y = membrane_stiffness(s, e);
    out.push_back(Y ? spring_N_per_m(s, e, *Y) : std::numeric_limits<double>::infinity());
  }
  return out;
}

std::vector<std::uint32_t> neighbours_of(const Cloth& cloth) {
  const auto all = triangles(cloth);
  std::vector<std::uint32_t> out(3 * all.size(), CLOTHBENCH_NONE);
  std::map<std::pair<std::uint32_t, std::uint32_t>, std::size_t> first;  // side number of the first triangle there
  for (std::size_t side = 0; side < out.size(); ++side) {
    const auto& t = all[side / 3];
    const auto [at, is_new] = first.try_emplace(std::minmax(t[side % 3], t[(side + 1) % 3]), side);
    if (is_new) continue;
    out[side] = static_cast<std::uint32_t>(at->second / 3);
    out[at->second] = static_cast<std::uint32_t>(side / 3);
  }
  return out;
}

/// In the cloth's frame, the middle of a grid at 0.
Vec3 local_rest(const Cloth& c, std::size_t v) {
  if (c.mesh) return c.mesh->vertices[v];
  const int i = static_cast<int>(v) % c.columns, j = static_cast<int>(v) / c.columns;
  return {c.line_u_m(i) - c.width_m / 2, j * c.dv() - c.height_m / 2, 0};
}

}  // namespace

RestShape::RestShape(const Scene& s)
    : neighbours(neighbours_of(s.cloth)),
      structural_N_per_m(springs_of(s, EdgeKind::Structural)),
      poisson_ratio(s.cloth.mesh || s.needs.has(Feature::Shear) ? 1.0 / 3 : 0) {
  if (s.needs.has(Feature::Shear)) shear_N_per_m = springs_of(s, EdgeKind::Shear);
  const Cloth& c = s.cloth;
  const Vec3 &u = c.axis_u, &v = c.axis_v;
  const Vec3 n = {u[1] * v[2] - u[2] * v[1], u[2] * v[0] - u[0] * v[2], u[0] * v[1] - u[1] * v[0]};
  for (std::size_t k = 0; k < c.vertex_count(); ++k) {
    const Vec3 at = local_rest(c, k);
    for (std::size_t d = 0; d < 3; ++d)
      position_m.push_back(c.center_m[d] + at[0] * u[d] + at[1] * v[d] + at[2] * n[d]);
    if (!c.mesh) pattern_m.insert(pattern_m.end(), {at[0] + c.width_m / 2, at[1] + c.height_m / 2});
  }
}

}  // namespace clothbench::plugin

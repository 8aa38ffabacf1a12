#include <algorithm>
#include <cmath>

#include "clothbench/scene.hpp"

namespace clothbench {
namespace {

/// Length share of grid line `i` of `n`, in cells: half a cell at the border.
double share(int i, int n) { return i == 0 || i == n - 1 ? 0.5 : 1.0; }

}  // namespace

Vec3 Scene::rest_position(int i, int j) const {
  const double u = i * cloth.du() - cloth.width_m / 2, v = j * cloth.dv() - cloth.height_m / 2;
  Vec3 p{};
  for (int k = 0; k < 3; ++k) p[k] = cloth.center_m[k] + u * cloth.axis_u[k] + v * cloth.axis_v[k];
  return p;
}

std::vector<double> vertex_masses(const Scene& scene) {
  const Cloth& c = scene.cloth;
  const double cell = c.areal_density_kg_per_m2 * c.du() * c.dv();
  std::vector<double> mass;
  mass.reserve(c.vertex_count());
  for (int j = 0; j < c.rows; ++j)
    for (int i = 0; i < c.columns; ++i) mass.push_back(cell * share(i, c.columns) * share(j, c.rows));
  return mass;
}

std::vector<double> initial_positions(const Scene& scene) {
  std::vector<double> x;
  x.reserve(3 * scene.cloth.vertex_count());
  for (int j = 0; j < scene.cloth.rows; ++j)
    for (int i = 0; i < scene.cloth.columns; ++i)
      for (double value : scene.rest_position(i, j)) x.push_back(value);
  return x;
}

std::vector<std::array<std::uint32_t, 3>> triangles(const Cloth& c) {
  std::vector<std::array<std::uint32_t, 3>> out;
  out.reserve(2u * (c.columns - 1) * (c.rows - 1));
  for (int j = 0; j + 1 < c.rows; ++j)
    for (int i = 0; i + 1 < c.columns; ++i) {
      const auto a = static_cast<std::uint32_t>(j * c.columns + i), b = a + 1, d = a + c.columns, e = d + 1;
      out.push_back({a, b, e});
      out.push_back({a, e, d});
    }
  return out;
}

std::vector<Edge> edges(const Cloth& c, EdgeKind kind) {
  struct Step {
    int di, dj;
  };
  std::vector<Step> steps;
  switch (kind) {
    case EdgeKind::Structural: steps = {{1, 0}, {0, 1}}; break;
    case EdgeKind::Shear: steps = {{1, 1}, {-1, 1}}; break;
    case EdgeKind::SkipOne: steps = {{2, 0}, {0, 2}}; break;
  }
  std::vector<Edge> out;
  for (const Step& s : steps) {
    const double rest = std::hypot(s.di * c.du(), s.dj * c.dv());
    for (int j = 0; j + s.dj < c.rows; ++j)
      for (int i = std::max(0, -s.di); i + std::max(0, s.di) < c.columns; ++i)
        out.push_back({static_cast<std::uint32_t>(j * c.columns + i),
                       static_cast<std::uint32_t>((j + s.dj) * c.columns + i + s.di), rest, kind});
  }
  return out;
}

}  // namespace clothbench

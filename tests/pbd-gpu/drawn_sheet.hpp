#pragma once
#include <algorithm>
#include <random>

#include "mesh_scene.hpp"

namespace clothbench::pbd_gpu {

/// Delaunay triangles of points that are not all on one line (Bowyer 1981; Watson 1981), wound alike. Triangles flatter
/// than a thousandth of a square of side `cell` are left out: they lie along straight borders.
inline std::vector<std::array<std::uint32_t, 3>> delaunay(std::vector<std::array<double, 2>> p, double cell) {
  using Triangle = std::array<std::uint32_t, 3>;
  const auto n = static_cast<std::uint32_t>(p.size());
  const auto area2 = [&](const Triangle& t) {
    return (p[t[1]][0] - p[t[0]][0]) * (p[t[2]][1] - p[t[0]][1]) -
           (p[t[1]][1] - p[t[0]][1]) * (p[t[2]][0] - p[t[0]][0]);
  };
  const auto holds = [&](const Triangle& t, std::uint32_t v) {  // the circle round t has v inside
    double m[3][3];
    for (std::size_t k = 0; k < 3; ++k) {
      m[k][0] = p[t[k]][0] - p[v][0];
      m[k][1] = p[t[k]][1] - p[v][1];
      m[k][2] = m[k][0] * m[k][0] + m[k][1] * m[k][1];
    }
    return m[0][0] * (m[1][1] * m[2][2] - m[1][2] * m[2][1]) - m[0][1] * (m[1][0] * m[2][2] - m[1][2] * m[2][0]) +
               m[0][2] * (m[1][0] * m[2][1] - m[1][1] * m[2][0]) >
           0;
  };
  for (const auto& far : {std::array{-1e4, -1e4}, {1e4, -1e4}, {0.0, 1e4}}) p.push_back(far);
  std::vector<Triangle> all = {{n, n + 1, n + 2}};
  for (std::uint32_t v = 0; v < n; ++v) {
    std::vector<std::array<std::uint32_t, 2>> rim;  // directed edges of the hole
    std::vector<Triangle> left;
    for (const Triangle& t : all) {
      if (!holds(t, v)) {
        left.push_back(t);
        continue;
      }
      for (std::size_t k = 0; k < 3; ++k) {
        const std::array<std::uint32_t, 2> edge = {t[k], t[(k + 1) % 3]}, back = {edge[1], edge[0]};
        if (const auto twin = std::find(rim.begin(), rim.end(), back); twin != rim.end())
          rim.erase(twin);
        else
          rim.push_back(edge);
      }
    }
    for (const auto& [a, b] : rim) left.push_back({a, b, v});
    all = std::move(left);
  }
  std::erase_if(all, [&](const Triangle& t) {
    return *std::max_element(t.begin(), t.end()) >= n || area2(t) < 2e-3 * cell * cell;
  });
  return all;
}

/// A sheet of width x height m along x and y, pinned along x = 0. Its inner vertices are those of a square lattice,
/// turned by an angle, each moved by up to a share of a cell.
inline Scene drawn_sheet(double width, double height, int cells, double angle, double share, unsigned seed) {
  std::mt19937 random(seed);
  // Not std::uniform_real_distribution, which differs between libraries.
  const auto draw = [&] { return 2 * (static_cast<double>(random()) / 4294967296.0) - 1; };
  const double cell = width / cells;
  const int rows = static_cast<int>(std::lround(height / cell));
  std::vector<std::array<double, 2>> p;
  for (int i = 0; i <= cells; ++i)
    for (int j = 0; j <= rows; ++j)
      if (i == 0 || j == 0 || i == cells || j == rows) p.push_back({i * cell, height * j / rows});
  for (int i = -2 * cells; i <= 2 * cells; ++i)
    for (int j = -2 * cells; j <= 2 * cells; ++j) {
      const double u = (i + 0.3) * cell, v = (j + 0.4) * cell, c = std::cos(angle), s = std::sin(angle);
      const double x = width / 2 + c * u - s * v + share * cell * draw(),
                   y = height / 2 + s * u + c * v + share * cell * draw();
      if (std::min({x, y, width - x, height - y}) > 0.45 * cell) p.push_back({x, y});
    }
  std::vector<Vec3> at;
  std::vector<std::uint32_t> pins;
  for (const auto& [x, y] : p) {
    if (x == 0) pins.push_back(static_cast<std::uint32_t>(at.size()));
    at.push_back({x, y, 0});
  }
  return of_mesh(cloth_mesh(std::move(at), delaunay(p, cell), "sheet"), std::move(pins));
}

}  // namespace clothbench::pbd_gpu

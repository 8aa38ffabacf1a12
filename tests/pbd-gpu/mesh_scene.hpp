#pragma once
#include <cmath>
#include <numbers>

#include "gpu_fixture.hpp"
#include "strips.hpp"

namespace clothbench::pbd_gpu {

/// A square sheet of n x n vertices, displaced inside, with diagonals in both directions; two corners are pinned.
inline Scene mesh_sheet(int n) {
  std::vector<Vec3> x;
  std::vector<std::array<std::uint32_t, 3>> t;
  for (int j = 0; j < n; ++j)
    for (int i = 0; i < n; ++i) {
      const bool inside = i > 0 && j > 0 && i + 1 < n && j + 1 < n;
      const double a = inside ? 0.25 * std::sin(12.9898 * i + 78.233 * j) : 0,
                   b = inside ? 0.25 * std::sin(39.346 * i + 11.135 * j) : 0;
      x.push_back({(i + a) / (n - 1) - 0.5, (j + b) / (n - 1) - 0.5, 0});
    }
  for (int j = 0; j + 1 < n; ++j)
    for (int i = 0; i + 1 < n; ++i) {
      const auto p = static_cast<std::uint32_t>(j * n + i), q = p + 1, r = p + static_cast<std::uint32_t>(n), s = r + 1;
      if ((i + j) % 3 != 0) {
        t.push_back({p, q, s});
        t.push_back({p, s, r});
      } else {
        t.push_back({p, q, r});
        t.push_back({q, s, r});
      }
    }
  return of_mesh(cloth_mesh({std::move(x), std::move(t)}, "sheet"), {0, static_cast<std::uint32_t>(n - 1)});
}

/// A tube of radius 0.2 m and length 0.5 m around z, with borders only at its two ends.
inline Scene mesh_tube(int around, int along) {
  std::vector<Vec3> x;
  std::vector<std::array<std::uint32_t, 3>> t;
  for (int j = 0; j < along; ++j)
    for (int i = 0; i < around; ++i) {
      const double angle = 2 * std::numbers::pi * i / around;
      x.push_back({0.2 * std::cos(angle), 0.2 * std::sin(angle), 0.5 * j / (along - 1)});
    }
  for (int j = 0; j + 1 < along; ++j)
    for (int i = 0; i < around; ++i) {
      const auto at = [&](int a, int b) { return static_cast<std::uint32_t>(b * around + a % around); };
      t.push_back({at(i, j), at(i + 1, j), at(i + 1, j + 1)});
      t.push_back({at(i, j), at(i + 1, j + 1), at(i, j + 1)});
    }
  return of_mesh(cloth_mesh({std::move(x), std::move(t)}, "tube"), {});
}

/// The scene with one column of cells `factor` times as wide.
inline Scene uneven(Scene s, std::size_t column, double factor) {
  s.cloth.column_factors.assign(static_cast<std::size_t>(s.cloth.columns - 1), 1);
  s.cloth.column_factors[column] = factor;
  s.needs.add(Feature::UnevenGrid);
  return s;
}

}  // namespace clothbench::pbd_gpu

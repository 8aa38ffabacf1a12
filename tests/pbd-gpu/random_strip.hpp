#pragma once
#include <random>

#include "mesh_scene.hpp"

namespace clothbench::pbd_gpu {

/// A strip of 1 m x 0.25 m along x of cells x cells/4 squares, halved along drawn diagonals. Vertices inside are moved
/// by up to a share of a cell; the first two columns are as they are, and pinned.
inline Scene random_strip(int cells, double share, unsigned seed) {
  std::mt19937 random(seed);
  // Not std::uniform_real_distribution, which differs between libraries.
  const auto draw = [&] { return 2 * (static_cast<double>(random()) / 4294967296.0) - 1; };
  const int across = cells / 4;
  std::vector<Vec3> x;
  std::vector<std::array<std::uint32_t, 3>> t;
  std::vector<std::uint32_t> pins;
  for (int i = 0; i <= cells; ++i)
    for (int j = 0; j <= across; ++j) {
      const double a = i > 1 && i < cells ? share * draw() : 0, b = i > 1 && j > 0 && j < across ? share * draw() : 0;
      if (i < 2) pins.push_back(static_cast<std::uint32_t>(x.size()));
      x.push_back({(i + a) / cells, 0.25 * (j + b) / across, 0});
    }
  for (int i = 0; i < cells; ++i)
    for (int j = 0; j < across; ++j) {
      const auto a = static_cast<std::uint32_t>(i * (across + 1) + j), b = a + static_cast<std::uint32_t>(across) + 1,
                 c = b + 1, d = a + 1;
      if (draw() > 0) {
        t.push_back({a, b, c});
        t.push_back({a, c, d});
      } else {
        t.push_back({a, b, d});
        t.push_back({b, c, d});
      }
    }
  return of_mesh(cloth_mesh(std::move(x), std::move(t), "strip"), std::move(pins));
}

}  // namespace clothbench::pbd_gpu

#pragma once
#include <cstdint>
#include <vector>

#include "clothbench/scene.hpp"

namespace clothbench::plugin {

/// The cloth at rest, as the C interface shows it: see ClothbenchScene for layout and units.
struct RestShape {
  explicit RestShape(const Scene&);
  std::vector<double> position_m;         ///< (vertices, 3)
  std::vector<double> pattern_m;          ///< (vertices, 2); empty for a mesh
  std::vector<std::uint32_t> neighbours;  ///< (triangles, 3)
  std::vector<double> structural_N_per_m, shear_N_per_m;
  double poisson_ratio = 0;
};

}  // namespace clothbench::plugin

#pragma once
#include <string>
#include <vector>

#include "report/pairs.hpp"

namespace clothbench {

/// A triangle mesh (`other`) beside a grid (`run`) of about as many vertices: pairs "grid" (pairs.hpp).
struct MeshBesideGrid : RunPair {
  /// The grid's run of the same solver that takes the least GPU time of those that stretch by at most as much in the
  /// mean as the mesh; null if there is none.
  const RunRecord* as_taut = nullptr;
  double ratio_as_taut() const;  ///< GPU time of the mesh over that of `as_taut`
};

/// All of them, by mesh and solver. `runs` must outlive the result.
std::vector<MeshBesideGrid> meshes_beside_grids(const std::vector<RunRecord>& runs);

/// Rows: mesh x solver. Columns: GPU time [ms], mean stretch of structural edges in the last second [%], ratios.
Table mesh_grid_table(const std::vector<MeshBesideGrid>&);
std::string mesh_grid_csv(const std::vector<MeshBesideGrid>&);

}  // namespace clothbench

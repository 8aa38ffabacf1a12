#pragma once
#include <array>

#include "assets/room.hpp"
#include "clothbench/scene.hpp"

namespace clothbench {

/// Initial pose of a sheet above a table.
struct TablePose {
  Vec3 center_m{}, axis_u{}, axis_v{};
};

/// A level rectangle: its centre, the directions of its sides (unit vectors), and their lengths.
struct Footprint {
  Vec3 center_m{};
  std::array<Vec3, 2> axes{};
  std::array<double, 2> size_m{};
};

/// Height [m] of the mesh's highest point above or below the rectangle; -infinity if nothing is there.
double highest_below(const ColliderMesh&, const Footprint&);

/// Level, centred on the table and aligned with its sides, `drop_m` above the highest point of `mesh` below the cloth.
/// Throws Error if no part of the mesh is below the cloth.
TablePose flat_over(const assets::Table&, const ColliderMesh& mesh, const Cloth&, double drop_m);

/// Corner first: the lowest corner is `drop_m` above the table and `inset_m` inside the middle of a long edge. One
/// diagonal rises at `tilt` [rad] along that edge; the other is level and across it, so that half the cloth is beyond
/// the edge if `inset_m` is 0.
TablePose corner_first_over(const assets::Table&, const Cloth&, double drop_m, double tilt, double inset_m);

}  // namespace clothbench

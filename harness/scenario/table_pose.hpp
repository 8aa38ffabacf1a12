#pragma once
#include "assets/room.hpp"
#include "clothbench/scene.hpp"

namespace clothbench {

/// Initial pose of a sheet above a table.
struct TablePose {
  Vec3 center_m{}, axis_u{}, axis_v{};
};

/// Level, centred on the table and aligned with its sides, `drop_m` above the highest point of `mesh` below the cloth.
/// Throws Error if no part of the mesh is below the cloth.
TablePose flat_over(const assets::Table&, const ColliderMesh& mesh, const Cloth&, double drop_m);

/// Corner first: the lowest corner is `drop_m` above the middle of a long edge of the table. One diagonal rises at
/// `tilt` [rad] along that edge; the other is level and across the edge, so that half the cloth is beyond it.
TablePose corner_first_over(const assets::Table&, const Cloth&, double drop_m, double tilt);

}  // namespace clothbench

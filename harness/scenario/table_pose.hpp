#pragma once
#include "assets/room.hpp"
#include "clothbench/scene.hpp"

namespace clothbench {

/// Where a sheet lies before it is let go.
struct TablePose {
  Vec3 center_m{}, axis_u{}, axis_v{};
};

/// Level, centred on the table and along its sides, `drop_m` above the highest point of `mesh` below the cloth.
/// Throws Error if nothing of the mesh is below it.
TablePose flat_over(const assets::Table&, const ColliderMesh& mesh, const Cloth&, double drop_m);

/// Corner first: its lowest corner `drop_m` above the middle of a long edge of the table, one diagonal rising at `tilt`
/// [rad] along that edge, the other level and across it, so that half the cloth is outside.
TablePose corner_first_over(const assets::Table&, const Cloth&, double drop_m, double tilt);

}  // namespace clothbench

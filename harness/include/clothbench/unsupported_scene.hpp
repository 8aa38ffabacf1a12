#pragma once
#include <string>

#include "clothbench/error.hpp"
#include "clothbench/scene.hpp"

namespace clothbench {

/// Thrown by ClothSolver::load: the solver supports every feature that the scene needs, but not this scene at these
/// settings. The run ends as `unsupported`, with this reason.
class UnsupportedScene : public SolverError {
 public:
  explicit UnsupportedScene(const std::string& message) : SolverError(message) {}
};

/// For solvers that can bend only grids. Throws if the scene has a triangle mesh that resists
/// bending.
inline void refuse_mesh_bending(const Scene& scene) {
  if (scene.cloth.mesh && scene.material.bending_rigidity_N_m > 0)
    throw UnsupportedScene("it has no resistance to bending for triangle meshes; the solvers reference and xpbd have");
}

}  // namespace clothbench

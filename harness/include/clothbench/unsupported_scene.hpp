#pragma once
#include <string>

#include "clothbench/error.hpp"

namespace clothbench {

/// Thrown by ClothSolver::load: the solver supports every feature that the scene needs, but not this scene at these
/// settings. The run ends as `unsupported`, with this reason.
class UnsupportedScene : public SolverError {
 public:
  explicit UnsupportedScene(const std::string& message) : SolverError(message) {}
};

}  // namespace clothbench

#pragma once
#include <functional>
#include <memory>
#include <string>

#include "clothbench/solver.hpp"

namespace clothbench {

/// Draws what a frame ends with, as an application would show it: for the frame time with rendering.
class FrameDrawer {
 public:
  virtual ~FrameDrawer() = default;
  /// The cloth as the solver holds it after frame `frame` (0 = the start), with what it touches; all drawn on return.
  virtual void draw(int frame) = 0;
};

/// How frames are drawn where a study asks for it; both empty where it does not.
struct Rendering {
  /// What is drawn and where positions come from, for the result file.
  std::function<std::string(const SolverInfo&)> describe;
  /// One for a loaded solver, which it reads and which outlives it.
  std::function<std::unique_ptr<FrameDrawer>(const Scene&, const ClothSolver&, const DeviceOptions&)> make;
};

}  // namespace clothbench

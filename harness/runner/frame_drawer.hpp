#pragma once
#include <functional>
#include <memory>
#include <string>

#include "clothbench/solver.hpp"

namespace clothbench {

/// Draws the state at the end of a frame as an application would show it; used for the frame time with rendering.
class FrameDrawer {
 public:
  virtual ~FrameDrawer() = default;
  /// Draws the cloth as the solver holds it after frame `frame` (0 = the start), and the colliders; complete on return.
  virtual void draw(int frame) = 0;
};

/// How frames are drawn in studies that time rendering; both are empty in others.
struct Rendering {
  /// Describes, for the result file, what is drawn and where positions come from.
  std::function<std::string(const SolverInfo&)> describe;
  /// Makes a drawer for a loaded solver, which the drawer reads and which must outlive it.
  std::function<std::unique_ptr<FrameDrawer>(const Scene&, const ClothSolver&, const DeviceOptions&)> make;
};

}  // namespace clothbench

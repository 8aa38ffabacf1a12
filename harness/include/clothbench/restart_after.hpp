#pragma once
#include "clothbench/solver.hpp"

namespace clothbench {

/// A solver whose restart depends on the moment of the scene, for example on where hands are then.
class RestartsAtMoment {
 public:
  virtual ~RestartsAtMoment() = default;
  /// As ClothSolver::restart, for the state at the end of frame `last`.
  virtual bool restart_at(const ClothState&, const FrameInput& last) = 0;
};

/// Continues from the state at the end of frame `last`. Returns false and changes nothing if positions and velocities
/// are not the whole state.
inline bool restart_after(ClothSolver& solver, const ClothState& state, const FrameInput& last) {
  auto* at_moment = dynamic_cast<RestartsAtMoment*>(&solver);
  return at_moment != nullptr ? at_moment->restart_at(state, last) : solver.restart(state);
}

}  // namespace clothbench

#pragma once
#include <memory>
#include <vector>

#include "clothbench/scene.hpp"

namespace clothbench {

struct ScenePassage;

/// Where the cloth touches the colliders of its scene, and how it slides on them, frame after frame.
///
/// A point of the cloth touches a collider up to the distance at which the solver holds cloth plus a tolerance: a tenth
/// of that distance or a thousandth of the cloth's shorter side, whichever is greater. A triangle touches if any of its
/// points does, edges and face included. Sliding is that of vertices.
class ColliderTouch {
 public:
  /// `scene` outlives this. `held_at_m` as for ColliderPassage.
  ColliderTouch(const Scene& scene, const std::vector<double>& held_at_m);
  ~ColliderTouch();
  ColliderTouch(const ColliderTouch&) = delete;
  ColliderTouch& operator=(const ColliderTouch&) = delete;

  /// Fills in touching_fraction and slip_m. Finite positions [m] at the end of frame `frame`, every frame in order.
  void probe(int frame, const std::vector<double>& positions, ScenePassage& out);
  /// The state of this frame is not finite: no vertex touched in it.
  void skip() { before_.clear(); }

 private:
  struct Watch;
  std::unique_ptr<Watch> watch_;
  std::vector<double> before_;  ///< positions at the last frame; empty at the start and after a skip
};

}  // namespace clothbench

#pragma once
#include <memory>
#include <vector>

#include "clothbench/scene.hpp"

namespace clothbench {

struct SceneTouch;

/// Where the cloth touches the colliders of its scene, and how it slides on them, frame after frame.
///
/// A point of the cloth touches a collider up to the distance at which the solver holds cloth plus a tolerance: a tenth
/// of that distance or a thousandth of the cloth's shorter side, whichever is greater. A triangle touches if any of its
/// points does, edges and face included. Sliding is that of vertices.
class ColliderTouch {
 public:
  /// `scene` outlives this. `held_at_m`: how far off each collider the solver keeps cloth, as in
  /// Plan::contact_margins_m.
  ColliderTouch(const Scene& scene, const std::vector<double>& held_at_m);
  ~ColliderTouch();
  ColliderTouch(const ColliderTouch&) = delete;
  ColliderTouch& operator=(const ColliderTouch&) = delete;

  /// Positions [m] at the end of frame `frame`, every frame in order. In a frame that is not finite no vertex touches.
  SceneTouch probe(int frame, const std::vector<double>& positions);

 private:
  struct Watch;
  std::unique_ptr<Watch> watch_;
  std::vector<double>
      before_;  ///< positions at the last frame; empty at the start and after a state that is not finite
};

}  // namespace clothbench

#pragma once
#include <memory>
#include <vector>

#include "metrics/metric.hpp"

namespace clothbench {

/// Where the cloth passed through the colliders of its scene and how it slides on them, frame after frame. Over several
/// colliders: samples on the wrong side of any, axes of all that pierce the cloth, triangles that touch any, mean
/// sliding distance over all touches.
///
/// Samples are the vertices and the cell centres. A vertex is weighted by its rest area, a cell centre by the cell's
/// area. A collider comes from the side of the sheet's initial plane on which the middle of its centre line starts.
/// collider_touch.hpp says what touches.
class ColliderPassage {
 public:
  /// `scene` outlives this. `held_at_m`: how far off each collider the solver holds cloth, as in
  /// Plan::contact_margins_m.
  explicit ColliderPassage(const Scene& scene, const std::vector<double>& held_at_m = {});
  ~ColliderPassage();
  ColliderPassage(const ColliderPassage&) = delete;
  ColliderPassage& operator=(const ColliderPassage&) = delete;

  /// Positions [m] at the end of frame `frame`, 0 = the initial state; every frame once and in order. `contours_m`: of
  /// ColliderContact in the same frame.
  ScenePassage probe(int frame, const std::vector<double>& positions, const std::vector<double>& contours_m);

 private:
  struct Watch;
  std::unique_ptr<Watch> watch_;
};

}  // namespace clothbench

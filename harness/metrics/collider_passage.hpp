#pragma once
#include <memory>
#include <vector>

#include "metrics/metric.hpp"

namespace clothbench {

/// Whether cloth can get to the wrong side of a collider: it must move and have a centre line. These are capsules and
/// hands with 25 joints.
bool has_centre_line(const Collider&);

/// Where the cloth passed through the colliders of its scene and how it slides on them, frame after frame. Over several
/// colliders: samples on the wrong side of any, vertices that touch any, mean sliding distance over all touches.
///
/// Samples are the vertices and the cell centres. A vertex is weighted by its share of area, a cell centre by the
/// cell's area. A collider comes from the side of the sheet's initial plane on which the middle of its centre line
/// starts. A vertex touches a collider up to the distance at which the solver holds cloth plus a tolerance: a tenth of
/// that distance or a thousandth of the cloth's shorter side, whichever is greater.
class ColliderPassage {
 public:
  /// `scene` outlives this. `held_at_m`: how far off each collider the solver holds cloth, as in
  /// Plan::contact_margins_m.
  explicit ColliderPassage(const Scene& scene, const std::vector<double>& held_at_m = {});
  ~ColliderPassage();
  ColliderPassage(const ColliderPassage&) = delete;
  ColliderPassage& operator=(const ColliderPassage&) = delete;

  /// Positions [m] at the end of frame `frame`, 0 = the initial state; every frame once and in order.
  ScenePassage probe(int frame, const std::vector<double>& positions);

 private:
  struct Watch;
  std::unique_ptr<Watch> watch_;
};

}  // namespace clothbench

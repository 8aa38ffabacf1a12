#pragma once
#include <memory>
#include <vector>

#include "metrics/metric.hpp"

namespace clothbench {

/// Whether cloth can get on its wrong side: colliders that move and have a centre line, capsules and the hands of 25
/// joints.
bool has_centre_line(const Collider&);

/// Where the cloth went past the colliders of its scene and how it slides on them, frame after frame. What is asked of
/// more than one collider: samples on the wrong side of any, vertices that touch any, the mean way slid of all touches.
///
/// Samples are the vertices and the centres of the cells, a vertex with its share of area and a cell with its own. A
/// collider came from the side of the sheet's starting plane on which the middle of its centre line starts. A vertex
/// touches a collider up to a tenth beyond the distance at which the solver holds it, or a thousandth of the cloth's
/// shorter side.
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

#pragma once
#include <memory>
#include <vector>

#include "clothbench/scene.hpp"
#include "metrics/contact/surface.hpp"
#include "scenario/collider_kinds.hpp"

namespace clothbench {

struct SceneTouch;

/// Where the cloth touches the colliders of its scene, and how it slides on them, frame after frame.
///
/// A point of the cloth touches a collider up to the distance at which the solver holds cloth plus a tolerance: a tenth
/// of that distance or a thousandth of the cloth's shorter side, whichever is greater. A triangle touches if any of its
/// points does, edges and face included. Only vertices slide.
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

std::vector<contact::Capsule> contact_capsules(const std::vector<Capsule>&);

/// Pose of a collider of the scene at the end of a frame, 0 = the start.
const ColliderPose& pose_at(const Scene&, std::size_t collider, int frame);

/// The triangles of a collider whose kind has a surface.
std::unique_ptr<contact::TriangleTree> triangles_of(const Collider&, const ColliderPose&);

/// Signed distance to a collider at one instant, for kinds that have a closed form. The other kinds use triangles.
class ClosedForm {
 public:
  static bool has(const Collider& c) { return kind_of(c).nearest != nullptr || kind_of(c).capsules != nullptr; }
  /// `was`: its pose at the previous frame. The collider must outlive this.
  ClosedForm(const Collider&, const ColliderPose& now, const ColliderPose& was);
  contact::Nearest operator()(const contact::Point<3>&) const;

 private:
  const Collider& collider_;
  const ColliderKind& kind_;
  std::vector<contact::Capsule> now_, was_;
};

}  // namespace clothbench

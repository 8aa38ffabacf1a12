#pragma once
#include <vector>

#include "metrics/contact/surface.hpp"
#include "scenario/collider_kinds.hpp"

namespace clothbench {

std::vector<contact::Capsule> contact_capsules(const std::vector<Capsule>&);

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

#include "metrics/collider_surface.hpp"

namespace clothbench {

std::vector<contact::Capsule> contact_capsules(const std::vector<Capsule>& capsules) {
  std::vector<contact::Capsule> out;
  for (const Capsule& c : capsules) out.push_back({contact::point(c.a_m), contact::point(c.b_m), c.radius_m});
  return out;
}

ClosedForm::ClosedForm(const Collider& c, const ColliderPose& now, const ColliderPose& was)
    : collider_(c), kind_(kind_of(c)) {
  if (kind_.nearest != nullptr) return;
  now_ = contact_capsules(kind_.capsules(c, now));
  was_ = contact_capsules(kind_.capsules(c, was));
}

contact::Nearest ClosedForm::operator()(const contact::Point<3>& p) const {
  if (kind_.nearest == nullptr) return contact::nearest(p, now_, was_);
  const SurfacePlace found = kind_.nearest(collider_, {p[0], p[1], p[2]});
  return {found.distance_m, contact::point(found.normal), contact::Point<3>::Zero()};
}

}  // namespace clothbench

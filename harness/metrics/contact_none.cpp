// Built without CGAL, as on a headset: contact is not measured. motion_check works for scenes without colliders.
#include "clothbench/error.hpp"
#include "metrics/collider_contact.hpp"
#include "metrics/motion_check/motion.hpp"

namespace clothbench {

std::unique_ptr<ColliderContact> collider_contact(const Scene&, const std::vector<double>&) {
  throw Error("this build has no contact metrics");
}

SelfContact self_contact(const std::vector<double>&, const std::vector<std::array<std::uint32_t, 3>>&) {
  throw Error("this build has no contact metrics");
}

std::unique_ptr<motion_check::Bodies> motion_check::bodies_of(const Motion&, std::span<const double>) {
  return std::make_unique<Bodies>();
}

}  // namespace clothbench

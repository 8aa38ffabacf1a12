// Replaces collider_contact.cpp and collider_touch.cpp where CGAL's kernel is not available, as on a device.
#include "clothbench/error.hpp"
#include "metrics/collider_contact.hpp"
#include "metrics/collider_touch.hpp"

namespace clothbench {

struct ColliderContact::Probes {};

ColliderContact::ColliderContact(const Scene&) { throw Error("this build has no contact metrics"); }
ColliderContact::~ColliderContact() = default;
SceneContact ColliderContact::probe(int, const std::vector<double>&) {
  throw Error("this build has no contact metrics");
}

SelfContact self_contact(const std::vector<double>&, const std::vector<std::array<std::uint32_t, 3>>&) {
  throw Error("this build has no contact metrics");
}

struct ColliderTouch::Watch {};

ColliderTouch::ColliderTouch(const Scene&, const std::vector<double>&) {
  throw Error("this build has no contact metrics");
}
ColliderTouch::~ColliderTouch() = default;
SceneTouch ColliderTouch::probe(int, const std::vector<double>&) { throw Error("this build has no contact metrics"); }

}  // namespace clothbench

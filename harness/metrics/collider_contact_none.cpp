// In place of collider_contact.cpp where CGAL's kernel is not to be had, as on a device.
#include "clothbench/error.hpp"
#include "metrics/collider_contact.hpp"

namespace clothbench {

struct ColliderContact::Probes {};

ColliderContact::ColliderContact(const Scene&) { throw Error("this build has no contact metrics"); }
ColliderContact::~ColliderContact() = default;
SceneContact ColliderContact::probe(int, const std::vector<double>&) { throw Error("this build has no contact metrics"); }

}  // namespace clothbench

#include "metrics/collider_contact.hpp"
#include "metrics/collider_passage.hpp"

namespace clothbench {

bool has_inside(const Collider& c) { return !c.mesh || c.mesh->closed || c.mesh->skinned(); }

bool counts_crossings(const Collider& c) { return c.mesh != nullptr; }

bool has_centre_line(const Collider& c) {
  constexpr std::size_t kHandJoints = 25;  // of the WebXR Hand Input module
  return !c.capsules.empty() || (c.mesh && c.mesh->skinned() && c.mesh->joint_count == kHandJoints);
}

}  // namespace clothbench

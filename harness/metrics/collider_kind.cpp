#include "clothbench/error.hpp"
#include "metrics/collider_contact.hpp"
#include "metrics/collider_passage.hpp"

namespace clothbench {

bool has_inside(const Collider& c) {
  switch (c.shape) {
    case Collider::Shape::Plane:
    case Collider::Shape::Sphere:
    case Collider::Shape::Box:
    case Collider::Shape::Capsules:
      return true;
    case Collider::Shape::Mesh:
      return c.mesh->closed || c.mesh->skinned();
  }
  throw Error("collider " + c.name + ": no such shape");
}

bool counts_crossings(const Collider& c) { return c.shape == Collider::Shape::Mesh; }

bool has_centre_line(const Collider& c) {
  constexpr std::size_t kHandJoints = 25;  // of the WebXR Hand Input module
  if (c.shape == Collider::Shape::Capsules) return true;
  return c.shape == Collider::Shape::Mesh && c.mesh->skinned() && c.mesh->joint_count == kHandJoints;
}

}  // namespace clothbench

#include "clothbench/error.hpp"
#include "metrics/collider_contact.hpp"

namespace clothbench {

bool has_inside(const Collider& c) {
  switch (c.shape) {
    case Collider::Shape::Plane:
    case Collider::Shape::Sphere:
    case Collider::Shape::Box:
    case Collider::Shape::Capsules: return true;
    case Collider::Shape::Mesh: return c.mesh->closed || c.mesh->skinned();
  }
  throw Error("collider " + c.name + ": no such shape");
}

bool counts_crossings(const Collider& c) { return c.shape == Collider::Shape::Mesh; }

}  // namespace clothbench

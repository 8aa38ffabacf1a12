#pragma once
#include <vector>

#include "clothbench/scene.hpp"
#include "metrics/contact/triangle_mesh.hpp"

namespace clothbench {

namespace contact {
/// A segment of an object's centre line: the axis of a capsule, or a bone of a hand.
using Bone = std::array<Point<3>, 2>;
}  // namespace contact

/// A point of a hand's centre line that moves with one joint.
struct MedialPoint {
  std::size_t joint;
  contact::Point<3> at_rest;
};

/// The centre line of one collider in any pose: the axes of its capsules, or in a hand mesh the segments through the
/// middles of the flesh round each joint of the fingers. Empty for other colliders.
class CentreLine {
 public:
  explicit CentreLine(const Collider& c);
  std::vector<contact::Bone> at(const ColliderPose& pose) const;

 private:
  std::vector<std::array<MedialPoint, 2>> bones_;
};

}  // namespace clothbench

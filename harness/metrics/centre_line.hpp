#pragma once
#include <vector>

#include "metrics/contact/wrong_side.hpp"

namespace clothbench {

/// A point of a hand's centre line that moves with one joint.
struct MedialPoint {
  std::size_t joint;
  contact::Point<3> at_rest;
};

/// The centre line of one collider in any pose: the axes of its capsules, or in a hand mesh the segments through the
/// middles of the flesh round each joint of the fingers. Empty for colliders without one (has_centre_line).
class CentreLine {
 public:
  explicit CentreLine(const Collider& c);
  std::vector<contact::Bone> at(const ColliderPose& pose) const;

 private:
  std::vector<std::array<MedialPoint, 2>> bones_;
};

}  // namespace clothbench

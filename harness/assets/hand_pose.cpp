#include "assets/hand_pose.hpp"

#include <algorithm>

namespace clothbench::assets {

int joint_index(std::string_view name) {
  const auto found = std::find(kJointNames.begin(), kJointNames.end(), name);
  return found == kJointNames.end() ? -1 : static_cast<int>(found - kJointNames.begin());
}

HandPose mirrored(const HandPose& pose) {
  HandPose out = pose;
  const Eigen::DiagonalMatrix<double, 3> flip(-1, 1, 1);
  for (std::size_t j = 0; j < kJointCount; ++j) {
    out.joints[j].linear() = flip * pose.joints[j].linear() * flip;
    out.joints[j].translation() = flip * pose.joints[j].translation();
  }
  return out;
}

Frame palm_frame(const HandPose& pose) {
  const Frame& bone = pose.joints[kMiddle];
  Frame palm = Frame::Identity();
  palm.linear().col(0) = bone.linear().col(0);
  palm.linear().col(1) = -bone.linear().col(2);
  palm.linear().col(2) = bone.linear().col(1);
  palm.translation() = (bone.translation() + pose.joints[kMiddle + 1].translation()) / 2;
  return palm;
}

HandPose moved(const HandPose& pose, const Frame& by) {
  HandPose out = pose;
  for (Frame& joint : out.joints) joint = by * joint;
  return out;
}

HandPose in_palm_frame(const HandPose& pose) { return moved(pose, palm_frame(pose).inverse()); }

HandPose blended(const HandPose& from, const HandPose& to, double t) {
  HandPose out;
  for (std::size_t j = 0; j < kJointCount; ++j) {
    const Eigen::Quaterniond a(from.joints[j].linear()), b(to.joints[j].linear());
    out.joints[j] = Frame::Identity();
    out.joints[j].linear() = a.slerp(t, b).normalized().toRotationMatrix();
    out.joints[j].translation() = (1 - t) * from.joints[j].translation() + t * to.joints[j].translation();
    out.radius_m[j] = (1 - t) * from.radius_m[j] + t * to.radius_m[j];
  }
  return out;
}

Vector pinch_point(const HandPose& pose) {
  return (pose.joints[kThumb + 3].translation() + pose.joints[kIndex + 4].translation()) / 2;
}

std::array<Capsule, kCapsuleCount> capsules(const HandPose& pose) {
  constexpr double kDistalLength = 0.015;
  std::array<Capsule, kCapsuleCount> out;
  std::size_t count = 0;
  const auto add = [&](std::size_t joint, bool distal) {
    const Vector a = pose.joints[joint].translation();
    Vector b = pose.joints[joint + 1].translation();
    const double length = (b - a).norm();
    if (distal && length > kDistalLength) b = a + (b - a) * (kDistalLength / length);
    out[count++] = {a, b, pose.radius_m[joint], static_cast<int>(joint)};
  };
  for (std::size_t finger : {kIndex, kMiddle, kRing, kPinky}) add(finger, false);
  for (std::size_t k = 0; k < 3; ++k) add(kThumb + k, k == 2);
  for (std::size_t finger : {kIndex, kMiddle, kRing, kPinky})
    for (std::size_t k = 1; k < 4; ++k) add(finger + k, k == 3);
  return out;
}

}  // namespace clothbench::assets

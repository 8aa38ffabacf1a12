
#include "assets/hand.hpp"

#include <algorithm>
#include <regex>

#include "base/json_text.hpp"
#include "base/words.hpp"
#include "clothbench/error.hpp"
#include "clothbench/solver.hpp"

namespace clothbench::assets {
namespace {

/// The object literal of a module as JSON: names in double quotes, no trailing commas.
std::string as_json(const std::string& text, const std::string& source) {
  const std::size_t start = text.find("= {"), end = text.rfind("};");
  if (start == std::string::npos)
    throw Error(source + ": no \"= {\": expected a module that exports an object literal");
  if (end == std::string::npos || end < start)
    throw Error(source + ": the object literal is not closed (file cut off?)");
  static const std::regex names(R"((['"]?)([\w-]+)\1\s*:)"), commas(R"(,(\s*[\]}]))");
  const std::string literal = text.substr(start + 2, end - start - 1);
  return std::regex_replace(std::regex_replace(literal, names, "\"$2\":"), commas, "$1");
}

constexpr char kPoseSchema[] = R"({
  "type": "object", "required": ["jointTransforms"], "properties": {
    "jointTransforms": {"type": "object", "additionalProperties": {
      "type": "object", "required": ["offsetMatrix", "radius"], "properties": {
        "offsetMatrix": {"type": "array", "minItems": 16, "maxItems": 16, "items": {"type": "number"}},
        "radius": {"type": "number", "exclusiveMinimum": 0, "maximum": 0.1}}}}
  }
})";

}  // namespace

int joint_index(std::string_view name) {
  const auto found = std::find(kJointNames.begin(), kJointNames.end(), name);
  return found == kJointNames.end() ? -1 : static_cast<int>(found - kJointNames.begin());
}

HandPose parse_pose_js(const std::string& text, const std::string& source) {
  const nlohmann::json document = parse_json(as_json(text, source), source + " (as JSON)");
  validate_json(document, kPoseSchema, source);
  HandPose pose;
  for (std::size_t k = 0; k < kJointCount; ++k) {
    const std::string name(kJointNames[k]);
    const auto joint = document["jointTransforms"].find(name);
    if (joint == document["jointTransforms"].end()) refuse(source, "/jointTransforms", in_quotes(name) + " is missing");
    const auto numbers = (*joint)["offsetMatrix"].get<std::array<double, 16>>();
    const Eigen::Matrix4d m = Eigen::Map<const Eigen::Matrix4d>(numbers.data());
    const Eigen::Matrix3d r = m.topLeftCorner<3, 3>();
    if (!((r.transpose() * r - Eigen::Matrix3d::Identity()).cwiseAbs().maxCoeff() <= 1e-3) || !(r.determinant() > 0) ||
        !(m.row(3) == Eigen::RowVector4d(0, 0, 0, 1)))
      refuse(source, "/jointTransforms/" + name + "/offsetMatrix",
             "expected a rotation and a translation, columns first");
    pose.joints[k] = Frame::Identity();
    pose.joints[k].linear() = Eigen::Quaterniond(r).normalized().toRotationMatrix();
    pose.joints[k].translation() = m.topRightCorner<3, 1>();
    pose.radius_m[k] = (*joint)["radius"].get<double>();
  }
  return pose;
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

const HandPose& Hand::pose(const std::string& name) const {
  const auto found = poses.find(name);
  if (found != poses.end()) return found->second;
  std::vector<std::string> known;
  for (const auto& [n, unused] : poses) known.push_back(n);
  throw Error("hand: no pose " + in_quotes(name) + nearest_known(name, known));
}

}  // namespace clothbench::assets

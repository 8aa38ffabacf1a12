#include "assets/hand.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "assets/gltf_file.hpp"
#include "base/json_text.hpp"
#include "base/words.hpp"
#include "clothbench/error.hpp"

namespace clothbench::assets {
namespace {

using gltf::fail, gltf::pick, gltf::world_transforms;

std::vector<double> numbers(const tinygltf::Model& model, int index, int type, std::initializer_list<int> kinds,
                            const std::string& source) {
  return gltf::numbers(model, index, type, kinds, source, "a WebXR hand model");
}

int attribute(const tinygltf::Primitive& primitive, const char* name, const std::string& source) {
  const auto found = primitive.attributes.find(name);
  if (found == primitive.attributes.end())
    fail(source, fmt::format("/meshes/0/primitives/0/attributes: \"{}\" is missing", name));
  return found->second;
}

/// The skin's joints as indices into kJointNames; fills the inverses of the joints' rest frames.
std::vector<std::uint8_t> read_skin(const tinygltf::Model& model, SkinnedMesh& hand, const std::string& source) {
  const auto& skin = pick(model.skins, 0, source, "skins");
  const auto inverse =
      numbers(model, skin.inverseBindMatrices, TINYGLTF_TYPE_MAT4, {TINYGLTF_COMPONENT_TYPE_FLOAT}, source);
  if (inverse.size() != 16 * skin.joints.size())
    fail(source, "/skins/0: expected one inverse bind matrix for each joint");
  const auto world = world_transforms(model, source);
  std::vector<std::uint8_t> joints;
  std::array<bool, kJointCount> seen{};
  for (std::size_t j = 0; j < skin.joints.size(); ++j) {
    const auto& node = pick(model.nodes, skin.joints[j], source, "nodes");
    const int known = joint_index(node.name);
    if (known < 0)
      fail(source, fmt::format("/skins/0/joints/{}: {} is not a WebXR hand joint", j, in_quotes(node.name)));
    const auto slot = static_cast<std::size_t>(known);
    const Eigen::Affine3d& bind = world[static_cast<std::size_t>(skin.joints[j])];
    hand.inverse_bind[slot].matrix() = Eigen::Map<const Eigen::Matrix4d>(inverse.data() + 16 * j);
    if (!(((bind * hand.inverse_bind[slot]).matrix() - Eigen::Matrix4d::Identity()).cwiseAbs().maxCoeff() <= 1e-3))
      fail(source, fmt::format("/skins/0: bind matrix of \"{}\" does not invert its node matrix", node.name));
    seen[slot] = true;
    joints.push_back(static_cast<std::uint8_t>(known));
  }
  for (std::size_t j = 0; j < kJointCount; ++j)
    if (!seen[j]) fail(source, fmt::format("/skins/0/joints: \"{}\" is missing", kJointNames[j]));
  return joints;
}

/// Converts a module's object literal to JSON: names in double quotes, no trailing commas.
std::string as_json(const std::string& text, const std::string& source) {
  const std::size_t start = text.find("= {"), end = text.rfind("};");
  if (start == std::string::npos)
    throw Error(source + ": no \"= {\": expected a module that exports an object literal");
  if (end == std::string::npos || end < start)
    throw Error(source + ": the object literal is not closed (file cut off?)");
  const std::string literal = text.substr(start + 2, end - start - 1);
  return regex_replaced(regex_replaced(literal, R"((['"]?)([\w-]+)\1\s*:)", "\"$2\":"), R"(,(\s*[\]\x7d]))", "$1");
}

constexpr char kPoseSchema[] =
#include "hand_pose.schema.inc"
    ;

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
    out[count++] = {a, b, pose.radius_m[joint]};
  };
  for (std::size_t finger : {kIndex, kMiddle, kRing, kPinky}) add(finger, false);
  for (std::size_t k = 0; k < 3; ++k) add(kThumb + k, k == 2);
  for (std::size_t finger : {kIndex, kMiddle, kRing, kPinky})
    for (std::size_t k = 1; k < 4; ++k) add(finger + k, k == 3);
  return out;
}

SkinnedMesh parse_hand_glb(const std::string& bytes, const std::string& source) {
  const tinygltf::Model model = gltf::parse_binary(bytes, source);
  if (model.meshes.size() != 1 || model.meshes[0].primitives.size() != 1)
    fail(source, "/meshes: expected one mesh of one primitive");
  const auto& primitive = model.meshes[0].primitives[0];
  if (primitive.mode != TINYGLTF_MODE_TRIANGLES) fail(source, "/meshes/0/primitives/0/mode: expected triangles");
  const int f32 = TINYGLTF_COMPONENT_TYPE_FLOAT, u8 = TINYGLTF_COMPONENT_TYPE_UNSIGNED_BYTE,
            u16 = TINYGLTF_COMPONENT_TYPE_UNSIGNED_SHORT, u32 = TINYGLTF_COMPONENT_TYPE_UNSIGNED_INT;
  SkinnedMesh hand;
  const auto names = read_skin(model, hand, source);
  const auto positions = numbers(model, attribute(primitive, "POSITION", source), TINYGLTF_TYPE_VEC3, {f32}, source);
  const auto joints = numbers(model, attribute(primitive, "JOINTS_0", source), TINYGLTF_TYPE_VEC4, {u8, u16}, source);
  const auto weights = numbers(model, attribute(primitive, "WEIGHTS_0", source), TINYGLTF_TYPE_VEC4, {f32}, source);
  const auto indices = numbers(model, primitive.indices, TINYGLTF_TYPE_SCALAR, {u8, u16, u32}, source);
  const std::size_t count = positions.size() / 3;
  if (joints.size() != 4 * count || weights.size() != 4 * count || indices.size() % 3 != 0)
    fail(source, "/meshes/0/primitives/0: expected joints and weights for each position, and indices in threes");

  std::map<std::array<double, 3>, std::uint32_t> places;
  std::vector<std::uint32_t> welded(count);
  for (std::size_t v = 0; v < count; ++v) {
    const auto [place, is_new] = places.try_emplace({positions[3 * v], positions[3 * v + 1], positions[3 * v + 2]},
                                                    static_cast<std::uint32_t>(places.size()));
    welded[v] = place->second;
    if (!is_new) continue;
    hand.rest.add_vertex(Vector::Map(positions.data() + 3 * v));
    double sum = 0;
    for (std::size_t k = 0; k < 4; ++k) sum += weights[4 * v + k];
    if (!(std::abs(sum - 1) <= 1e-3))
      fail(source, fmt::format("WEIGHTS_0: vertex {} has weights of sum {}; expected 1", v, sum));
    auto& j = hand.joints.emplace_back();
    auto& w = hand.weights.emplace_back();
    for (std::size_t k = 0; k < 4; ++k) {
      j[k] = pick(names, static_cast<int>(joints[4 * v + k]), source, "skins/0/joints");
      w[k] = weights[4 * v + k] / sum;
    }
  }
  for (std::size_t i = 0; i < indices.size(); i += 3) {
    for (std::size_t k = 0; k < 3; ++k)
      if (!(indices[i + k] < static_cast<double>(count)))
        fail(source, fmt::format("triangle {} names vertex {}, but there are {}", i / 3, indices[i + k], count));
    const auto at = [&](std::size_t k) { return welded[static_cast<std::size_t>(indices[i + k])]; };
    hand.rest.triangles.push_back({at(0), at(1), at(2)});
  }
  return hand;
}

const HandPose& Hand::pose(const std::string& name) const {
  const auto found = poses.find(name);
  if (found != poses.end()) return found->second;
  std::vector<std::string> known;
  for (const auto& [n, unused] : poses) known.push_back(n);
  throw Error("hand: no pose " + in_quotes(name) + nearest_known(name, known));
}

}  // namespace clothbench::assets

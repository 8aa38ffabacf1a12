#include <fmt/format.h>

#include <cmath>
#include <map>

#include "assets/gltf_file.hpp"
#include "assets/hand.hpp"
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

/// The skin's joints as indices into kJointNames; fills the frames at rest.
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
      fail(source, fmt::format("/skins/0: the bind matrix of \"{}\" is not the inverse of its node", node.name));
    hand.bind[slot] = Frame::Identity();
    hand.bind[slot].linear() = Eigen::Quaterniond(bind.rotation()).normalized().toRotationMatrix();
    hand.bind[slot].translation() = bind.translation();
    seen[slot] = true;
    joints.push_back(static_cast<std::uint8_t>(known));
  }
  for (std::size_t j = 0; j < kJointCount; ++j)
    if (!seen[j]) fail(source, fmt::format("/skins/0/joints: \"{}\" is missing", kJointNames[j]));
  return joints;
}

}  // namespace

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

}  // namespace clothbench::assets

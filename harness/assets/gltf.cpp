#include <fmt/format.h>

#include <cmath>
#include <cstring>
#include <fstream>
#include <map>
#include <nlohmann/json.hpp>

#include "assets/hand.hpp"
#include "clothbench/error.hpp"
#define TINYGLTF_IMPLEMENTATION
#define TINYGLTF_NO_STB_IMAGE
#define TINYGLTF_NO_STB_IMAGE_WRITE
#define TINYGLTF_NO_EXTERNAL_IMAGE
#define TINYGLTF_NO_INCLUDE_JSON
#include <tiny_gltf.h>

namespace clothbench::assets {
namespace {

constexpr std::uintmax_t kMostBytes = 64u << 20;

[[noreturn]] void fail(const std::string& source, const std::string& message) { throw Error(source + ": " + message); }

/// `at` of a list that a file's index points into.
template <class List>
const auto& pick(const List& list, int index, const std::string& source, const char* what) {
  if (index < 0 || static_cast<std::size_t>(index) >= list.size())
    fail(source, fmt::format("/{}: index {}: expected less than {}", what, index, list.size()));
  return list[static_cast<std::size_t>(index)];
}

template <class Item>
Item item_at(const unsigned char* from) {
  Item item;
  std::memcpy(&item, from, sizeof(Item));
  return item;
}

/// One accessor as plain numbers, (count, components) row-major. tinygltf checks none of this.
std::vector<double> numbers(const tinygltf::Model& model, int index, int type, std::initializer_list<int> kinds,
                            const std::string& source) {
  const auto& accessor = pick(model.accessors, index, source, "accessors");
  const std::string where = fmt::format("/accessors/{}", index);
  if (accessor.type != type || std::find(kinds.begin(), kinds.end(), accessor.componentType) == kinds.end())
    fail(source, fmt::format("{}: type {} of component type {}: expected the types of a WebXR hand model", where,
                             accessor.type, accessor.componentType));
  if (accessor.sparse.isSparse || accessor.normalized)
    fail(source, where + ": expected an accessor that is neither sparse nor normalized");
  const auto& view = pick(model.bufferViews, accessor.bufferView, source, "bufferViews");
  const auto& buffer = pick(model.buffers, view.buffer, source, "buffers");
  const auto components = static_cast<std::size_t>(tinygltf::GetNumComponentsInType(static_cast<std::uint32_t>(type)));
  const auto item =
      static_cast<std::size_t>(tinygltf::GetComponentSizeInBytes(static_cast<std::uint32_t>(accessor.componentType)));
  const std::size_t row = components * item, stride = view.byteStride == 0 ? row : view.byteStride;
  const std::size_t size = buffer.data.size();
  if (view.byteOffset > size || view.byteLength > size - view.byteOffset || accessor.byteOffset > view.byteLength ||
      stride < row || stride > 252 || accessor.count == 0 || accessor.count > view.byteLength ||
      accessor.byteOffset + (accessor.count - 1) * stride + row > view.byteLength)
    fail(source, where + ": expected at least one item and no more than its buffer view holds");
  std::vector<double> out;
  out.reserve(accessor.count * components);
  for (std::size_t i = 0; i < accessor.count; ++i)
    for (std::size_t k = 0; k < components; ++k) {
      const unsigned char* from = buffer.data.data() + view.byteOffset + accessor.byteOffset + i * stride + k * item;
      switch (accessor.componentType) {
        case TINYGLTF_COMPONENT_TYPE_FLOAT:
          out.push_back(item_at<float>(from));
          break;
        case TINYGLTF_COMPONENT_TYPE_UNSIGNED_BYTE:
          out.push_back(*from);
          break;
        case TINYGLTF_COMPONENT_TYPE_UNSIGNED_SHORT:
          out.push_back(item_at<std::uint16_t>(from));
          break;
        default:
          out.push_back(item_at<std::uint32_t>(from));
          break;
      }
      if (!std::isfinite(out.back())) fail(source, fmt::format("{}: item {} is not finite", where, i));
    }
  return out;
}

int attribute(const tinygltf::Primitive& primitive, const char* name, const std::string& source) {
  const auto found = primitive.attributes.find(name);
  if (found == primitive.attributes.end())
    fail(source, fmt::format("/meshes/0/primitives/0/attributes: \"{}\" is missing", name));
  return found->second;
}

Eigen::Affine3d local_transform(const tinygltf::Node& node) {
  if (node.matrix.size() == 16) return Eigen::Affine3d(Eigen::Map<const Eigen::Matrix4d>(node.matrix.data()));
  Eigen::Affine3d t = Eigen::Affine3d::Identity();
  if (node.translation.size() == 3) t.translate(Vector::Map(node.translation.data()));
  if (node.rotation.size() == 4)
    t.rotate(Eigen::Quaterniond(node.rotation[3], node.rotation[0], node.rotation[1], node.rotation[2]).normalized());
  if (node.scale.size() == 3) t.scale(Vector::Map(node.scale.data()));
  return t;
}

/// World transforms of all nodes; a node that is its own ancestor, or has two parents, is refused.
std::vector<Eigen::Affine3d> world_transforms(const tinygltf::Model& model, const std::string& source) {
  std::vector<int> parent(model.nodes.size(), -1);
  for (std::size_t n = 0; n < model.nodes.size(); ++n)
    for (int child : model.nodes[n].children) {
      pick(model.nodes, child, source, "nodes");
      if (parent[static_cast<std::size_t>(child)] != -1) fail(source, fmt::format("/nodes/{}: has two parents", child));
      parent[static_cast<std::size_t>(child)] = static_cast<int>(n);
    }
  std::vector<Eigen::Affine3d> world(model.nodes.size());
  for (std::size_t n = 0; n < model.nodes.size(); ++n) {
    Eigen::Affine3d t = Eigen::Affine3d::Identity();
    std::size_t steps = 0;
    for (int at = static_cast<int>(n); at != -1; at = parent[static_cast<std::size_t>(at)]) {
      if (++steps > model.nodes.size()) fail(source, fmt::format("/nodes/{}: is its own ancestor", n));
      t = local_transform(model.nodes[static_cast<std::size_t>(at)]) * t;
    }
    world[n] = t;
  }
  return world;
}

tinygltf::Model parse(const std::vector<std::uint8_t>& bytes, const std::string& source) {
  tinygltf::TinyGLTF loader;
  tinygltf::Model model;
  std::string error, warning;
  bool ok = false;
  try {
    if (bytes.size() >= 12 && bytes.size() <= kMostBytes)
      ok = loader.LoadBinaryFromMemory(&model, &error, &warning, bytes.data(), static_cast<unsigned>(bytes.size()), "");
    else
      error = fmt::format("{} bytes", bytes.size());
  } catch (const std::exception& e) {
    error = e.what();
  }
  while (!error.empty() && error.back() == '\n') error.pop_back();
  if (!ok) fail(source, "not a binary glTF file (cut off?): " + (error.empty() ? "unreadable" : error));
  return model;
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
    if (known < 0) fail(source, fmt::format("/skins/0/joints/{}: \"{}\" is not a WebXR hand joint", j, node.name));
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

SkinnedMesh parse_hand_glb(const std::vector<std::uint8_t>& bytes, const std::string& source) {
  const tinygltf::Model model = parse(bytes, source);
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
  const std::size_t count = hand.stored_vertices = positions.size() / 3;
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

SkinnedMesh read_hand_glb(const std::filesystem::path& path) {
  std::ifstream in(path, std::ios::binary);
  if (!in) throw Error(path.string() + ": cannot be opened");
  std::error_code ec;
  const auto size = std::filesystem::file_size(path, ec);
  if (ec || size > kMostBytes) throw Error(path.string() + ": expected a regular file of at most 64 MiB");
  std::vector<std::uint8_t> bytes(size);
  in.read(reinterpret_cast<char*>(bytes.data()), static_cast<std::streamsize>(size));
  if (!in) throw Error(path.string() + ": cannot be read");
  return parse_hand_glb(bytes, path.string());
}

}  // namespace clothbench::assets

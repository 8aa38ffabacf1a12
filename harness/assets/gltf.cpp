#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <set>

#include "assets/gltf_file.hpp"
#include "assets/hand.hpp"
#include "assets/mesh_file.hpp"
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

using gltf::fail;

constexpr char kExpected[] = "a mesh: float32 positions, unsigned integers as indices";

/// Adds the nodes of one model to a MeshFile.
class MeshReader {
 public:
  MeshReader(const tinygltf::Model& model, const std::string& source) : model_(model), source_(source) {}

  MeshFile read() {
    const std::vector<Eigen::Affine3d> world = gltf::world_transforms(model_, source_);
    for (const std::size_t n : active_nodes()) {
      const tinygltf::Node& node = model_.nodes[n];
      if (node.mesh < 0) continue;
      if (node.skin >= 0) fail(source_, fmt::format("/nodes/{}/skin: expected a mesh without a skin", n));
      const tinygltf::Mesh& mesh = gltf::pick(model_.meshes, node.mesh, source_, "meshes");
      for (std::size_t p = 0; p < mesh.primitives.size(); ++p) {
        const std::size_t first = out_.triangles.size();
        primitive(mesh.primitives[p], world[n], node.weights.empty() ? mesh.weights : node.weights,
                  fmt::format("/meshes/{}/primitives/{}", node.mesh, p));
        std::vector<std::string> names = {node.name, mesh.name};
        if (const int m = mesh.primitives[p].material; m >= 0)
          names.push_back(gltf::pick(model_.materials, m, source_, "materials").name);
        add_groups(names, first);
      }
    }
    if (out_.triangles.empty()) fail(source_, "/nodes: expected a node with a mesh in the active scene");
    return std::move(out_);
  }

 private:
  /// Nodes of the active scene, or of the only scene if the file names none; all nodes of a file without scenes.
  std::set<std::size_t> active_nodes() const {
    const auto count = static_cast<int>(model_.scenes.size());
    if (model_.defaultScene < 0 && count > 1)
      fail(source_, fmt::format("/scene: missing; expected the index of the one of its {} scenes to read", count));
    std::vector<int> todo;
    if (count > 0)
      todo = gltf::pick(model_.scenes, std::max(model_.defaultScene, 0), source_, "scenes").nodes;
    else
      for (std::size_t n = 0; n < model_.nodes.size(); ++n) todo.push_back(static_cast<int>(n));
    std::set<std::size_t> out;
    while (!todo.empty()) {
      const int n = todo.back();
      todo.pop_back();
      const tinygltf::Node& node = gltf::pick(model_.nodes, n, source_, "nodes");
      if (out.insert(static_cast<std::size_t>(n)).second)
        todo.insert(todo.end(), node.children.begin(), node.children.end());
    }
    return out;
  }

  using Attributes = std::map<std::string, int>;
  std::vector<double> attribute(const Attributes& of, const char* name, int type) const {
    const auto found = of.find(name);
    if (found == of.end()) return {};
    return gltf::numbers(model_, found->second, type, {TINYGLTF_COMPONENT_TYPE_FLOAT}, source_, kExpected);
  }

  std::vector<double> indices(const tinygltf::Primitive& p, std::size_t vertices) const {
    if (p.indices >= 0)
      return gltf::numbers(model_, p.indices, TINYGLTF_TYPE_SCALAR,
                           {TINYGLTF_COMPONENT_TYPE_UNSIGNED_BYTE, TINYGLTF_COMPONENT_TYPE_UNSIGNED_SHORT,
                            TINYGLTF_COMPONENT_TYPE_UNSIGNED_INT},
                           source_, kExpected);
    std::vector<double> all(vertices);
    for (std::size_t k = 0; k < vertices; ++k) all[k] = static_cast<double>(k);
    return all;
  }

  /// Positions with the displacements of morph targets added.
  std::vector<double> positions(const tinygltf::Primitive& p, const std::vector<double>& weights,
                                const std::string& where) const {
    std::vector<double> x = attribute(p.attributes, "POSITION", TINYGLTF_TYPE_VEC3);
    if (x.empty()) fail(source_, where + "/attributes: \"POSITION\" is missing");
    if (!weights.empty() && weights.size() != p.targets.size())
      fail(source_, fmt::format("{}/targets: {} morph targets, but {} weights; expected as many", where,
                                p.targets.size(), weights.size()));
    for (std::size_t k = 0; k < weights.size(); ++k) {
      if (weights[k] == 0) continue;
      const std::vector<double> d = attribute(p.targets[k], "POSITION", TINYGLTF_TYPE_VEC3);
      if (!d.empty() && d.size() != x.size())
        fail(source_, fmt::format("{}/targets/{}: expected as many displacements as positions", where, k));
      for (std::size_t i = 0; i < d.size(); ++i) x[i] += weights[k] * d[i];
    }
    return x;
  }

  void primitive(const tinygltf::Primitive& p, const Eigen::Affine3d& place, const std::vector<double>& weights,
                 const std::string& where) {
    if (p.mode != TINYGLTF_MODE_TRIANGLES) fail(source_, where + "/mode: expected triangles");
    const std::vector<double> x = positions(p, weights, where);
    const std::size_t count = x.size() / 3;
    const std::vector<double> corners = indices(p, count);
    if (corners.size() % 3 != 0) fail(source_, where + ": expected indices in threes");
    // Primitives may share one list of vertices; keep only vertices that triangles of this primitive use.
    constexpr std::uint32_t kNone = std::numeric_limits<std::uint32_t>::max();
    std::vector<std::uint32_t> taken(count, kNone);
    const bool mirrored = place.linear().determinant() < 0;
    for (std::size_t k = 0; k < corners.size(); k += 3) {
      std::array<std::uint32_t, 3> triangle{};
      for (std::size_t c = 0; c < 3; ++c) {
        const double named = corners[k + (mirrored ? 2 - c : c)];
        if (!(named < static_cast<double>(count)))
          fail(source_, fmt::format("{}: triangle {} names vertex {}, but there are {}", where, k / 3, named, count));
        const auto v = static_cast<std::size_t>(named);
        if (taken[v] == kNone) {
          taken[v] = static_cast<std::uint32_t>(out_.vertices.size());
          const Eigen::Vector3d at = place * Eigen::Vector3d::Map(x.data() + 3 * v);
          out_.vertices.push_back({at.x(), at.y(), at.z()});
        }
        triangle[c] = taken[v];
      }
      out_.triangles.push_back(triangle);
    }
  }

  void add_groups(const std::vector<std::string>& names, std::size_t first) {
    for (const std::string& name : names) {
      if (name.empty()) continue;
      std::vector<std::uint32_t>& group = out_.groups[name];
      for (std::size_t k = first; k < out_.triangles.size(); ++k)
        if (group.empty() || group.back() < k) group.push_back(static_cast<std::uint32_t>(k));
    }
  }

  const tinygltf::Model& model_;
  const std::string& source_;
  MeshFile out_;
};

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

MeshFile parse_gltf(const std::string& bytes, const std::string& source) {
  const bool binary = bytes.starts_with("glTF");
  const tinygltf::Model model = binary ? gltf::parse_binary(bytes, source) : gltf::parse_text(bytes, source);
  return MeshReader(model, source).read();
}

}  // namespace clothbench::assets

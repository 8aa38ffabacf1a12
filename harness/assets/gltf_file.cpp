#include "assets/gltf_file.hpp"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <limits>
#include <map>
#include <set>

// Makes tiny_gltf.h include its definitions. The #undef keeps the next file of a unity build from including them again.
#define TINYGLTF_IMPLEMENTATION
#include <tiny_gltf.h>
#undef TINYGLTF_IMPLEMENTATION

#include "assets/mesh.hpp"
#include "assets/mesh_file.hpp"
#include "base/json_text.hpp"
#include "base/words.hpp"
#include "clothbench/error.hpp"

namespace clothbench::assets::gltf {
namespace {

/// Schema for all values of a glTF 2.0 file that the readers use, because tinygltf skips values of a wrong type.
constexpr char kSchema[] =
#include "gltf.schema.inc"
    ;

constexpr std::uintmax_t kMostBytes = 256u << 20;

template <class Item>
Item item_at(const unsigned char* from) {
  Item item;
  std::memcpy(&item, from, sizeof(Item));
  return item;
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

/// Leaves every image empty: images are not needed, and this build cannot decode them.
bool leave_image(tinygltf::Image*, int, std::string*, std::string*, int, int, const unsigned char*, int, void*) {
  return true;
}

/// Extensions that change no position, so a file may require them.
bool is_appearance(const std::string& extension) {
  static const std::vector<std::string> kNames = {"KHR_lights_punctual", "KHR_texture_basisu", "KHR_texture_transform",
                                                  "EXT_texture_webp",    "EXT_texture_avif",   "KHR_xmp_json_ld"};
  return extension.starts_with("KHR_materials_") || contains(kNames, extension);
}

/// The JSON part of a file, with the types of its values checked.
nlohmann::json checked_json(const std::string& text, const std::string& source) {
  nlohmann::json parsed = parse_json(text, source);
  validate_json(parsed, kSchema, source);
  return parsed;
}

/// glTF 2.0, sections 3.2 and 3.12: conditions that a reader must not ignore.
void check_header(const tinygltf::Model& model, const std::string& source) {
  const tinygltf::Asset& asset = model.asset;
  if (!asset.minVersion.empty() && asset.minVersion != "2.0")
    fail(source, fmt::format("/asset/minVersion: {}; expected a file that a reader of \"2.0\" can read",
                             in_quotes(asset.minVersion)));
  if (!asset.version.starts_with("2."))
    fail(source, fmt::format("/asset/version: {}; expected \"2.0\"", in_quotes(asset.version)));
  for (std::size_t k = 0; k < model.extensionsRequired.size(); ++k)
    if (!is_appearance(model.extensionsRequired[k]))
      fail(source, fmt::format("/extensionsRequired/{}: {} is not supported; expected a file that does not need it", k,
                               in_quotes(model.extensionsRequired[k])));
}

template <class Load>
tinygltf::Model loaded(const std::string& source, const char* kind, Load load) {
  tinygltf::TinyGLTF loader;
  loader.SetImageLoader(leave_image, nullptr);
  tinygltf::Model model;
  std::string error, warning;
  bool ok = false;
  try {
    ok = load(loader, model, error, warning);
  } catch (const std::exception& e) {
    error = e.what();
  }
  while (!error.empty() && error.back() == '\n') error.pop_back();
  // Shortened, because the library's message may quote the file.
  if (!ok) fail(source, fmt::format("not a {}: {}", kind, error.empty() ? "unreadable" : shortened(error, 200)));
  check_header(model, source);
  return model;
}

}  // namespace

void fail(const std::string& source, const std::string& message) { throw Error(source + ": " + message); }

std::vector<double> numbers(const tinygltf::Model& model, int index, int type, std::initializer_list<int> kinds,
                            const std::string& source, const char* expected) {
  const auto& accessor = pick(model.accessors, index, source, "accessors");
  const std::string where = fmt::format("/accessors/{}", index);
  if (accessor.type != type || std::find(kinds.begin(), kinds.end(), accessor.componentType) == kinds.end())
    fail(source, fmt::format("{}: type {} of component type {}: expected the types of {}", where, accessor.type,
                             accessor.componentType, expected));
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
      std::uint32_t whole = 0;  // value of 1, 2 or 4 bytes
      if (accessor.componentType != TINYGLTF_COMPONENT_TYPE_FLOAT) std::memcpy(&whole, from, item);
      out.push_back(accessor.componentType == TINYGLTF_COMPONENT_TYPE_FLOAT ? double{item_at<float>(from)} : whole);
      if (!std::isfinite(out.back())) fail(source, fmt::format("{}: item {} is not finite", where, i));
    }
  return out;
}

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

tinygltf::Model parse_binary(const std::string& content, const std::string& source) {
  const auto* bytes = reinterpret_cast<const unsigned char*>(content.data());
  const std::size_t size = content.size();
  constexpr std::uint32_t kVersion = 2;
  if (size >= 12 && item_at<std::uint32_t>(bytes + 4) != kVersion)
    fail(source, fmt::format("not a binary glTF file of version {}: its version is {}", kVersion,
                             item_at<std::uint32_t>(bytes + 4)));
  constexpr std::size_t kText = 20;  // the text begins after the file's header and the chunk's length and type
  if (size >= kText && std::memcmp(bytes + 16, "JSON", 4) == 0 && item_at<std::uint32_t>(bytes + 12) <= size - kText)
    checked_json(content.substr(kText, item_at<std::uint32_t>(bytes + 12)), source);
  return loaded(source, "binary glTF file (cut off?)", [&](auto& loader, auto& model, auto& error, auto& warning) {
    if (size >= 12 && size <= kMostBytes)
      return loader.LoadBinaryFromMemory(&model, &error, &warning, bytes, static_cast<unsigned>(size), "");
    error = fmt::format("{} bytes", size);
    return false;
  });
}

tinygltf::Model parse_text(const std::string& text, const std::string& source) {
  const nlohmann::json parsed = checked_json(text, source);
  // The library would open any file named in the text, and the hash of a scene's mesh would not cover that file.
  const nlohmann::json buffers = parsed.value("buffers", nlohmann::json::array());
  for (std::size_t k = 0; k < buffers.size(); ++k)
    if (!buffers[k].value("uri", "").starts_with("data:"))
      fail(source, fmt::format("/buffers/{}/uri: expected the buffer inside the file: a data URI, or a .glb file", k));
  return loaded(source, "glTF file", [&](auto& loader, auto& model, auto& error, auto& warning) {
    return loader.LoadASCIIFromString(&model, &error, &warning, text.data(), static_cast<unsigned>(text.size()), "");
  });
}

}  // namespace clothbench::assets::gltf

namespace clothbench::assets {
namespace {

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
  /// Nodes of the active scene, or of the only scene if none is active; all nodes of a file without scenes.
  std::set<std::size_t> active_nodes() const {
    const auto count = static_cast<int>(model_.scenes.size());
    if (model_.defaultScene < 0 && count > 1)
      fail(source_, fmt::format("/scene: missing; expected the index of one of the {} scenes", count));
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

  /// Positions including the displacements of morph targets.
  std::vector<double> positions(const tinygltf::Primitive& p, const std::vector<double>& weights,
                                const std::string& where) const {
    std::vector<double> x = attribute(p.attributes, "POSITION", TINYGLTF_TYPE_VEC3);
    if (x.empty()) fail(source_, where + "/attributes: \"POSITION\" is missing");
    if (!weights.empty() && weights.size() != p.targets.size())
      fail(source_, fmt::format("{}/targets: {} morph targets, but {} weights; expected one for each", where,
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
    // Primitives may share one list of vertices, so only vertices of triangles are copied.
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

MeshFile parse_gltf(const std::string& bytes, const std::string& source) {
  const bool binary = bytes.starts_with("glTF");
  const tinygltf::Model model = binary ? gltf::parse_binary(bytes, source) : gltf::parse_text(bytes, source);
  return MeshReader(model, source).read();
}

}  // namespace clothbench::assets

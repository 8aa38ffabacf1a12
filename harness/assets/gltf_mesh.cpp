#include <limits>

#include "assets/gltf_file.hpp"
#include "assets/mesh_file.hpp"

namespace clothbench::assets {
namespace {

using gltf::fail;

constexpr char kExpected[] = "a mesh: float32 positions and texture coordinates, unsigned integers as indices";

/// Adds the nodes of one model to a MeshFile.
class MeshReader {
 public:
  MeshReader(const tinygltf::Model& model, const std::string& source) : model_(model), source_(source) {}

  MeshFile read() {
    const std::vector<Eigen::Affine3d> world = gltf::world_transforms(model_, source_);
    for (std::size_t n = 0; n < model_.nodes.size(); ++n) {
      const tinygltf::Node& node = model_.nodes[n];
      if (node.mesh < 0) continue;
      if (node.skin >= 0) fail(source_, fmt::format("/nodes/{}/skin: expected a mesh without a skin", n));
      const tinygltf::Mesh& mesh = gltf::pick(model_.meshes, node.mesh, source_, "meshes");
      for (std::size_t p = 0; p < mesh.primitives.size(); ++p) {
        const std::size_t first = out_.triangles.size();
        primitive(mesh.primitives[p], world[n], fmt::format("/meshes/{}/primitives/{}", node.mesh, p));
        std::vector<std::string> names = {node.name, mesh.name};
        if (const int m = mesh.primitives[p].material; m >= 0)
          names.push_back(gltf::pick(model_.materials, m, source_, "materials").name);
        add_groups(names, first);
      }
    }
    if (out_.triangles.empty()) fail(source_, "/nodes: expected a node with a mesh");
    return std::move(out_);
  }

 private:
  std::vector<double> attribute(const tinygltf::Primitive& p, const char* name, int type) const {
    const auto found = p.attributes.find(name);
    if (found == p.attributes.end()) return {};
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

  void primitive(const tinygltf::Primitive& p, const Eigen::Affine3d& place, const std::string& where) {
    if (p.mode != TINYGLTF_MODE_TRIANGLES) fail(source_, where + "/mode: expected triangles");
    for (const char* compressed : {"KHR_draco_mesh_compression", "EXT_meshopt_compression"})
      if (p.extensions.count(compressed) != 0)
        fail(source_, fmt::format("{}: {}: expected a mesh that is not compressed", where, compressed));
    const std::vector<double> x = attribute(p, "POSITION", TINYGLTF_TYPE_VEC3);
    if (x.empty()) fail(source_, where + "/attributes: \"POSITION\" is missing");
    const std::vector<double> texture = attribute(p, "TEXCOORD_0", TINYGLTF_TYPE_VEC2);
    const std::size_t count = x.size() / 3;
    if (!texture.empty() && texture.size() != 2 * count)
      fail(source_, where + "/attributes: expected as many texture coordinates as positions");
    const std::vector<double> corners = indices(p, count);
    if (corners.size() % 3 != 0) fail(source_, where + ": expected indices in threes");
    // Primitives may share one list of vertices, so only those that triangles name are taken.
    constexpr std::uint32_t kNone = std::numeric_limits<std::uint32_t>::max();
    std::vector<std::uint32_t> taken(count, kNone);
    const bool mirrored = place.linear().determinant() < 0;
    for (std::size_t k = 0; k < corners.size(); k += 3) {
      std::array<std::uint32_t, 3> triangle{};
      TextureTriangle t;
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
        constexpr double kMissing = std::numeric_limits<double>::quiet_NaN();
        if (texture.empty())
          t[c] = {kMissing, kMissing};
        else
          t[c] = {texture[2 * v], texture[2 * v + 1]};
      }
      out_.triangles.push_back(triangle);
      out_.texture.push_back(t);
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
  const tinygltf::Model model =
      binary ? gltf::parse_binary(reinterpret_cast<const std::uint8_t*>(bytes.data()), bytes.size(), source)
             : gltf::parse_text(bytes, source);
  return MeshReader(model, source).read();
}

}  // namespace clothbench::assets

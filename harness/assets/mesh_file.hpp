#pragma once
#include <array>
#include <cstdint>
#include <map>
#include <string>
#include <vector>

#include "clothbench/vector.hpp"

namespace clothbench::assets {

/// Texture coordinates of the three corners of a triangle; NaN where the file has none.
using TextureTriangle = std::array<std::array<double, 2>, 3>;

/// Triangles as a file has them; nothing of their shape is checked.
struct MeshFile {
  std::vector<Vec3> vertices;                           ///< [m]
  std::vector<std::array<std::uint32_t, 3>> triangles;  ///< vertices; an index may be out of range
  std::vector<TextureTriangle> texture;                 ///< one per triangle
  std::map<std::string, std::vector<std::uint32_t>>
      groups;  ///< triangles by name, ascending; a triangle may be in many
};

/// Reads the geometry of a glTF 2.0 file, binary (.glb) or text (.gltf) with all buffers inside. Triangles of all nodes
/// that have a mesh, placed by their nodes; the names of node, mesh and material are groups. Throws Error naming
/// `source` and the JSON pointer: no mesh, another primitive than triangles, a skin, compressed or damaged data.
MeshFile parse_gltf(const std::string& bytes, const std::string& source);

}  // namespace clothbench::assets

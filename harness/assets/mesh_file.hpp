#pragma once
#include <array>
#include <cstdint>
#include <map>
#include <string>
#include <vector>

#include "clothbench/vector.hpp"

namespace clothbench::assets {

/// Triangles as a file has them; nothing of their shape is checked.
struct MeshFile {
  std::vector<Vec3> vertices;                           ///< [m]
  std::vector<std::array<std::uint32_t, 3>> triangles;  ///< vertices; an index may be out of range
  std::map<std::string, std::vector<std::uint32_t>> groups =
      {};  ///< triangles by name, ascending; a triangle may be in many
  /// Lines of the file, from 1, for messages; empty if the file has no lines.
  std::vector<std::uint32_t> vertex_lines = {}, triangle_lines = {};
};

/// Reads the geometry of a glTF 2.0 file, binary (.glb) or text (.gltf) with all buffers inside. Triangles of the nodes
/// of the active scene that have a mesh, placed by their nodes and displaced by the weights of their morph targets; the
/// names of node, mesh and material are groups. Throws Error naming `source` and the JSON pointer: another version, a
/// required extension that changes positions, several scenes of which none is active, no mesh, another primitive than
/// triangles, a skin, compressed or damaged data.
MeshFile parse_gltf(const std::string& bytes, const std::string& source);

}  // namespace clothbench::assets

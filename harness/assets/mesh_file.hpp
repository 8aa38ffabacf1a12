#pragma once
#include <array>
#include <cstdint>
#include <map>
#include <string>
#include <vector>

#include "clothbench/vector.hpp"

namespace clothbench::assets {

/// Triangles as read from a file, without any checks of their shape.
struct MeshFile {
  std::vector<Vec3> vertices;                           ///< [m]
  std::vector<std::array<std::uint32_t, 3>> triangles;  ///< vertex indices, which may be out of range
  std::map<std::string, std::vector<std::uint32_t>> groups =
      {};  ///< names -> triangles, ascending; a triangle may have several names
  /// Line numbers in the file, from 1, for messages; empty if the file has no lines.
  std::vector<std::uint32_t> vertex_lines = {}, triangle_lines = {};
};

/// Reads the geometry of a glTF 2.0 file: binary (.glb), or text (.gltf) that contains all buffers. Reads triangles of
/// the active scene's nodes with a mesh, transformed by their nodes and displaced by the weights of their morph
/// targets; names of node, mesh and material become groups. Throws Error with `source` and JSON pointer for another
/// version, a required extension that changes positions, several scenes without an active one, no mesh, primitives
/// other than triangles, a skin, or compressed or damaged data.
MeshFile parse_gltf(const std::string& bytes, const std::string& source);

}  // namespace clothbench::assets

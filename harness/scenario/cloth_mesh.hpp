#pragma once
#include <array>
#include <memory>
#include <nlohmann/json_fwd.hpp>
#include <string>
#include <utility>
#include <vector>

#include "clothbench/scene.hpp"

namespace clothbench {

/// Reads `cloth.mesh` of a scene: {"file": a Wavefront OBJ beside the scene or in the scenario root}. Faces with more
/// than three corners are triangulated; normals, materials and texture coordinates are ignored. Adds "sha256" of the
/// file to `j`; a value that `j` already has must match. Throws Error with file and pointer if the file cannot be read
/// or is not a valid cloth (see cloth_mesh).
std::shared_ptr<const ClothMesh> read_cloth_mesh(nlohmann::json& j, const std::string& source);

/// The mesh in the text of an OBJ file.
ClothMesh parse_obj(const std::string& text, const std::string& source);

/// A cloth of these triangles. Throws Error naming `source` and the first invalid vertex, edge or triangle: not finite,
/// out of range, without area, duplicate, a vertex of no triangle, an edge of more than two triangles.
ClothMesh cloth_mesh(std::vector<Vec3> vertices, std::vector<std::array<std::uint32_t, 3>> triangles,
                     const std::string& source);

/// Longest and second longest side [m] of the mesh's bounding box.
std::pair<double, double> longest_sides(const ClothMesh&);

/// The vertex nearest to a point [m] in the mesh's frame; the first of several at the same distance.
std::uint32_t nearest_vertex(const ClothMesh&, const Vec3& point);

}  // namespace clothbench

#pragma once
#include <array>
#include <memory>
#include <nlohmann/json_fwd.hpp>
#include <string>
#include <utility>
#include <vector>

#include "clothbench/scene.hpp"

namespace clothbench {

/// `cloth.mesh` of a scene: {"file": a Wavefront OBJ beside the scene or in the scenario root}. Faces of more than
/// three corners are cut into triangles; normals, materials and texture coordinates are not looked at. Adds "sha256" of
/// the file to `j`, and where it has one already it must be that. Throws Error with file and pointer if it cannot be
/// read or is no cloth (see mesh_of).
std::shared_ptr<const ClothMesh> read_cloth_mesh(nlohmann::json& j, const std::string& source);

/// The mesh in the text of an OBJ file.
ClothMesh parse_obj(const std::string& text, const std::string& source);

/// A cloth of these triangles. Throws Error naming `source` and the first vertex or triangle that is none: not finite,
/// out of range, without area, the same twice, a vertex of no triangle, an edge of more than two triangles.
ClothMesh cloth_mesh(std::vector<Vec3> vertices, std::vector<std::array<std::uint32_t, 3>> triangles,
                     const std::string& source);

/// Longest and second longest side [m] of the box round it.
std::pair<double, double> longest_sides(const ClothMesh&);

/// The vertex nearest to a point of the mesh's own frame [m]; of equals the first.
std::uint32_t nearest_vertex(const ClothMesh&, const Vec3& point);

}  // namespace clothbench

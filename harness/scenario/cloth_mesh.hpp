#pragma once
#include <array>
#include <memory>
#include <nlohmann/json_fwd.hpp>
#include <string>
#include <utility>
#include <vector>

#include "assets/mesh_file.hpp"
#include "clothbench/scene.hpp"

namespace clothbench {

/// Reads `cloth.mesh` of a scene: {"file": a Wavefront OBJ or a glTF file beside the scene or in the scenario root}, or
/// {"drawn": a sheet of irregular triangles (drawn_mesh.hpp)}, to which the rest does not apply.
/// Faces with more than three corners are triangulated; normals and materials are ignored. Adds "sha256" of the
/// file to `j`; a value that `j` already has must match. Prints a notice on stderr, once per file, if vertices were
/// welded. Throws Error with file and pointer if the file cannot be read or is not a valid cloth (see cloth_mesh).
std::shared_ptr<const ClothMesh> read_cloth_mesh(nlohmann::json& j, const std::string& source);

/// The triangles in the text of an OBJ file; groups are the names of its lines "g" and "o".
assets::MeshFile read_obj(const std::string& text, const std::string& source);
/// The cloth in the text of an OBJ file.
ClothMesh parse_obj(const std::string& text, const std::string& source);

/// Corners of a triangle in the plane of its pattern [m].
using PatternTriangle = std::array<std::array<double, 2>, 3>;

/// The cloth of a file's triangles. Throws Error naming `source` and the first invalid vertex, edge or triangle: not
/// finite, out of range, without area (at the start or at rest), duplicate, a vertex of no triangle, an edge of more
/// than two triangles, neighbours that are wound oppositely. `pattern_m`: shape at rest of each triangle; empty: the
/// vertices give the rest shape.
ClothMesh cloth_mesh(assets::MeshFile, const std::string& source, std::vector<PatternTriangle> pattern_m = {});
/// The same of triangles whose vertices are their shape at rest.
ClothMesh cloth_mesh(std::vector<Vec3> vertices, std::vector<std::array<std::uint32_t, 3>> triangles,
                     const std::string& source);

/// Vertices of a named group of the cloth's mesh. Throws Error at `pointer` of the scene if the cloth is a grid, or has
/// no such group; names those that it has.
const std::vector<std::uint32_t>& group_vertices(const Cloth&, const std::string& name, const std::string& source,
                                                 const std::string& pointer);

/// The list of vertices at `pointer` of the scene. Throws Error for one that the cloth does not have.
std::vector<std::uint32_t> listed_vertices(const Cloth&, const nlohmann::json& list, const std::string& source,
                                           const std::string& pointer);

/// All vertices that an object of the scene names: "corners", "edge" and "clamp" of a grid, "group" and "nearest_m" (to
/// points in the mesh's frame; the first of several at the same distance) of a mesh, "vertices" of either. Throws Error
/// at `pointer` of the scene if it names none, or what the cloth does not have.
std::vector<std::uint32_t> selected_vertices(const Cloth&, const nlohmann::json&, const std::string& source,
                                             const std::string& pointer);

/// Longest and second longest side [m] of the mesh's bounding box.
std::pair<double, double> longest_sides(const ClothMesh&);

}  // namespace clothbench

#pragma once
#include <array>
#include <cstdint>
#include <memory>
#include <nlohmann/json_fwd.hpp>
#include <string>
#include <utility>
#include <vector>

#include "assets/mesh_file.hpp"
#include "clothbench/scene.hpp"
#include "clothbench/vector.hpp"

namespace clothbench {

/// Reads `cloth.mesh` of a scene: {"file": a Wavefront OBJ or a glTF file beside the scene or in the scenario root}, or
/// {"drawn": a sheet of irregular triangles (DrawnSheet)}, to which the rest does not apply.
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
/// As above, from triangles whose vertices are their shape at rest.
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

/// A flat sheet of irregular triangles, drawn by number: refined at will, and at any angle to its lattice.
struct DrawnSheet {
  double width_m = 1, height_m = 1;
  int cells = 8;           ///< along the width; cells along the height have nearly the same size
  double angle_rad = 0;    ///< of the lattice that inner vertices are of
  double share = 0;        ///< of a cell by which each of them is moved at most, 0 to 0.4
  std::uint32_t seed = 1;  ///< of those moves
  bool clamp =
      false;  ///< a second line of vertices, a cell from x = 0: attached together with the line x = 0, it is a clamp
  std::array<int, 2> copies = {1, 1};      ///< equal sheets along x and along z, centred on the first sheet's place
  std::array<double, 2> apart_m = {0, 0};  ///< between neighbours
};

/// Delaunay triangles (Bowyer 1981; Watson 1981) of a sheet in the plane z = 0, x from 0 to width_m and y from 0 to
/// height_m. Groups: its borders "u0" (x = 0), "u1", "v0" (y = 0) and "v1", and the two lines "clamp". The same sheet
/// has the same mesh.
ClothMesh drawn_mesh(const DrawnSheet&);

/// Reads `cloth.mesh.drawn`: the same sheet with its middle in the origin. Throws Error with the JSON pointer where it
/// would have more than 20 000 vertices, or all copies more than 2 000 000.
ClothMesh read_drawn_mesh(const nlohmann::json& drawn, const std::string& source);

/// Most corners of a polygon.
inline constexpr std::size_t kMostCorners = 1000;

/// Cuts a polygon, convex or not, into triangles inside it, wound as it is (ear clipping: Meisters 1975). The polygon
/// need not be flat: it is cut as seen along the axis nearest to its normal. `corners` [m]; the triangles hold indices
/// of corners. A corner at the position of the corner before it is in no triangle. Throws Error "<where>: ..." for a
/// polygon that has no area, crosses or touches itself, is too thin to be cut, or has over `kMostCorners` corners.
std::vector<std::array<std::uint32_t, 3>> triangulated(const std::vector<Vec3>& corners, const std::string& where);

/// A scene of a grid with the same cloth as a triangle mesh: the grid's vertices with the same numbers, each cell
/// cut along one of its diagonals, in an irregular pattern, its pattern as the shape at rest if the cloth starts bent.
/// Pins, grips, colliders and the start are the grid's. A mesh has one stiffness, so regions are left out, with
/// reference case and bounds of `expect`, which belong to the grid. Bending is also left out unless `bends`: some
/// solvers cannot bend meshes. A scene of a mesh is returned as it is.
Scene as_mesh(Scene, bool bends = false);

}  // namespace clothbench

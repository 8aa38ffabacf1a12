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

/// Reads `cloth.mesh` of a scene: {"file": an OBJ or glTF file next to the scene or in the scenario root}, or {"drawn":
/// a sheet of irregular triangles (DrawnSheet)}. For a file: faces with more than three corners are triangulated;
/// normals and materials are ignored. "sha256" of the file is added to `j`; if `j` has one already, it must match. If
/// vertices are welded, a notice is printed on stderr, once per file. Throws Error with file and pointer if the file
/// cannot be read or is not a valid cloth (see cloth_mesh).
std::shared_ptr<const ClothMesh> read_cloth_mesh(nlohmann::json& j, const std::string& source);

/// The triangles in the text of an OBJ file; its "g" and "o" statements name the groups.
assets::MeshFile read_obj(const std::string& text, const std::string& source);

/// Corners of a triangle in the plane of its pattern [m].
using PatternTriangle = std::array<std::array<double, 2>, 3>;

/// Makes a cloth from a file's triangles. Throws Error with `source` and the first invalid vertex, edge or triangle:
/// not finite, out of range, without area (initially or at rest), duplicate, a vertex of no triangle, an edge of more
/// than two triangles, neighbours with opposite winding. `pattern_m`: rest shape of each triangle; empty: the vertices
/// give the rest shape.
ClothMesh cloth_mesh(assets::MeshFile, const std::string& source, std::vector<PatternTriangle> pattern_m = {});

/// Vertices of a named group of the cloth's mesh. Throws Error at `pointer` of the scene if the cloth is a grid or has
/// no such group; the message lists the existing groups.
const std::vector<std::uint32_t>& group_vertices(const Cloth&, const std::string& name, const std::string& source,
                                                 const std::string& pointer);

/// The list of vertices at `pointer` of the scene. Throws Error for an index outside the cloth.
std::vector<std::uint32_t> listed_vertices(const Cloth&, const nlohmann::json& list, const std::string& source,
                                           const std::string& pointer);

/// All vertices that an object of the scene selects: "corners", "edge" and "clamp" of a grid; "group" and "nearest_m"
/// of a mesh (the vertices nearest to points in its frame; the first if equally near); "vertices" of either.
/// Throws Error at `pointer` of the scene if it selects none, or something that the cloth does not have.
std::vector<std::uint32_t> selected_vertices(const Cloth&, const nlohmann::json&, const std::string& source,
                                             const std::string& pointer);

/// Longest and second longest side [m] of the bounding box of a mesh; in several unconnected pieces, of the largest.
std::pair<double, double> longest_sides(const ClothMesh&);

/// A flat sheet of irregular triangles, generated from these numbers.
struct DrawnSheet {
  double width_m = 1, height_m = 1;
  int cells = 8;           ///< along the width; along the height, cells have nearly the same size
  double angle_rad = 0;    ///< rotation of the lattice of inner vertices
  double share = 0;        ///< maximum random offset of an inner vertex, as a fraction of a cell, 0 to 0.4
  std::uint32_t seed = 1;  ///< gives the random offsets
  bool clamp = false;      ///< adds a line of vertices one cell from the edge x = 0; attaching both makes a clamp
  std::array<int, 2> copies = {1, 1};      ///< equal sheets along x and z, centred on the position of a single one
  std::array<double, 2> apart_m = {0, 0};  ///< distances of neighbouring copies
};

/// Delaunay triangles (Bowyer 1981; Watson 1981) of a sheet in the plane z = 0, x from 0 to width_m and y from 0 to
/// height_m. Groups: borders "u0" (x = 0), "u1", "v0" (y = 0), "v1", and the two lines of "clamp". Equal input gives an
/// equal mesh.
ClothMesh drawn_mesh(const DrawnSheet&);

/// Reads `cloth.mesh.drawn`: a DrawnSheet with its centre at the origin. Throws Error with the JSON pointer if the
/// sheet would have more than 20 000 vertices, or all copies more than 11 000 000.
ClothMesh read_drawn_mesh(const nlohmann::json& drawn, const std::string& source);

/// Maximum number of corners of a polygon.
inline constexpr std::size_t kMostCorners = 1000;

/// Cuts a polygon, convex or not, into triangles that lie in it and have its winding (ear clipping: Meisters 1975). It
/// need not be flat: it is projected along the axis nearest to its normal. `corners` [m]; triangles hold indices of
/// corners. A corner at the position of the previous one is in no triangle. Throws Error "<where>: ..." for a polygon
/// without area, crossing or touching itself, too thin to cut, or with over `kMostCorners` corners.
std::vector<std::array<std::uint32_t, 3>> triangulated(const std::vector<Vec3>& corners, const std::string& where);

/// Converts a grid scene to one with the same cloth as a triangle mesh, with equal vertices and numbering. Each cell is
/// cut along one diagonal in an irregular pattern; if the cloth starts bent, the grid is the rest shape. Pins, grips,
/// colliders and the start stay. A mesh has one stiffness, so regions are removed, as are the reference case and the
/// bounds of `expect`, which hold for the grid. Bending is removed too unless `bends`, because some solvers cannot bend
/// meshes. A mesh scene is returned unchanged.
Scene as_mesh(Scene, bool bends = false);

}  // namespace clothbench

#pragma once
#include <array>
#include <cstdint>
#include <nlohmann/json_fwd.hpp>
#include <string>

#include "clothbench/scene.hpp"

namespace clothbench {

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

}  // namespace clothbench

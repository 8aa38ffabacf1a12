#pragma once
#include <array>
#include <vector>

#include "metrics/contact/winding.hpp"

namespace clothbench::contact {

/// How deep a cloth is in a closed object at one instant. The depth of a point is its distance to the object's surface
/// if it is inside, and 0 outside. Areas are those of the deformed cloth. A cloth that is nowhere inside gives zeros.
struct Depth {
  double max_m = 0;          ///< over all sample points; exact for capsules and spheres
  double vertex_max_m = 0;   ///< over the vertices alone
  double p99_m = 0;          ///< 99 % of the penetrating area is no deeper
  double mean_m = 0;         ///< over the penetrating area
  double area_m2 = 0;        ///< penetrating area
  double area_fraction = 0;  ///< of the cloth's area; multiplied by mean_m it is the mean depth of the whole cloth
};

/// The part of a triangle that lies inside; depth is interpolated linearly between the corners.
struct Piece {
  double area_m2 = 0;
  double depth_m = 0;  ///< mean
};

/// Pieces (0, 1 or 2) of a triangle with the signed depths `f` (positive inside) at its corners, appended to `pieces`.
/// Returns the length [m] of the line f = 0 in it.
double clip_to_inside(const Simplex<3>& corners, const std::array<double, 3>& f, std::vector<Piece>& pieces);

/// Area, mean and percentile of pieces; reorders them.
void summarize(std::vector<Piece>& pieces, double cloth_area_m2, Depth& depth);

/// Depth of a cloth in a closed or nearly closed mesh.
///
/// Sampled at the vertices, the edge midpoints and the centroids: vertices alone miss a finger that comes up through
/// the middle of a triangle. A point is inside if its winding number is > 1/2; its depth is the distance to the nearest
/// triangle. The seven points of a cloth triangle span six triangles, which are clipped at depth 0. So area and mean
/// converge with the square of the cloth's edge length, which counting points would not achieve.
class MeshDepth {
 public:
  explicit MeshDepth(const TriangleMeshView& cloth_topology);

  /// `cloth` must have the triangles given at construction, and finite positions.
  Depth operator()(const TriangleMeshView& cloth, const TriangleTree& object, const InsideTest& inside) const;

 private:
  std::size_t vertices_;
  std::vector<std::array<std::uint32_t, 2>> edges_;
  std::vector<std::array<std::uint32_t, 3>> triangle_edges_;  ///< edge i of a triangle joins corners i and i + 1
};

}  // namespace clothbench::contact

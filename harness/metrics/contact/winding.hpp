#pragma once
#include <vector>

#include "metrics/contact/triangle_mesh.hpp"

namespace clothbench::contact {

/// Generalised winding number (Jacobson, Kavan & Sorkine-Hornung 2013) of a point about a triangle mesh: the sum of
/// the signed solid angles of all triangles (van Oosterom & Strackee 1983) over 4 pi. With outward normals it is 1
/// inside a closed mesh and 0 outside; for an open mesh only the change by 1 across the sheet is meaningful. Exact up
/// to rounding; the time is proportional to the number of triangles.
double winding_number(const Point<3>& p, const TriangleTree& mesh);

/// Tests whether a point is inside: winding number > 1/2.
class InsideTest {
 public:
  /// `closed`: the mesh has no border (is_closed). Then the winding number is the number of signed crossings along a
  /// ray to infinity, an exact integer. For a mesh with a border, clusters of triangles far from the point count as one
  /// dipole (first term of Barill et al. 2018, clusters beyond 3 of their radii), and a value within 0.2 of 1/2 is
  /// summed in full. `mesh` must outlive this.
  InsideTest(const TriangleTree& mesh, bool closed);

  bool operator()(const Point<3>& p) const;
  /// The value compared with 1/2, before any full sum.
  double estimate(const Point<3>& p) const;

 private:
  struct Cluster {
    Point<3> area_vector = Point<3>::Zero();  ///< sum of half cross products [m^2]
    Point<3> centre = Point<3>::Zero();       ///< mean of centroids weighted by area
    double area = 0, radius = 0;
  };
  void build_clusters();
  double clustered_winding_number(const Point<3>& p) const;
  int crossings_to_infinity(const Point<3>& p) const;

  const TriangleTree& mesh_;
  bool closed_;
  std::vector<Cluster> clusters_;  ///< one per node of the hierarchy
};

}  // namespace clothbench::contact

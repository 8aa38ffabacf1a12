#pragma once
#include <vector>

#include "metrics/contact/triangle_mesh.hpp"

namespace clothbench::contact {

/// Signed crossings of the straight path p -> q with a static mesh: the number along the normals minus the number
/// against. Exact (predicates.hpp): a path through a common edge or vertex, or one that ends on the surface, is counted
/// once.
int signed_crossings(const Point<3>& p, const Point<3>& q, const TriangleTree& mesh);

/// Whether a point is inside a closed mesh with outward normals: its winding number, which is the number of signed
/// crossings on a ray to infinity, is positive. Exact.
bool is_inside(const Point<3>& p, const TriangleTree& mesh);

/// A mesh whose vertices move from `from` to `to` during one step.
///
/// A vertex of the cloth and the mesh both move, so the crossing happens in space-time. There the path is a straight
/// segment, and each moving triangle sweeps a prism that is cut into three tetrahedra (staircase over the vertex order,
/// so that neighbours agree about their common wall). Cutting replaces the linear motion inside a triangle by a
/// piecewise linear one with the same beginning and end. Both have the same sum of signed crossings as long as the path
/// does not cross the moving border of an open mesh: the volume between the two surfaces is empty at the beginning and
/// at the end, so a path that enters it also leaves it. No root is searched for, and the orientation tests are exact.
class SweptMesh {
 public:
  /// `from` and `to` share their triangles; `welded` from welded_vertices(from), so that repeated vertices share walls.
  SweptMesh(const TriangleMeshView& from, const TriangleMeshView& to, std::span<const std::uint32_t> welded);

  /// Signed crossings of the path from p, when the mesh is at `from`, to q, when it is at `to`.
  int signed_crossings(const Point<3>& p, const Point<3>& q) const;

 private:
  struct Prism {
    Simplex<3> from, to;  ///< corners in vertex order
    int orientation;      ///< -1 if that order reverses the normal
  };
  std::vector<Prism> prisms_;
  BoxTree tree_;
};

/// Signed crossings of each vertex of a cloth that moves past a static mesh in one step. `links` between the vertices;
/// without them every crossing counts.
///
/// The straight path between two frames may cut a border that the vertex moved around. If no link crosses the mesh
/// before or after the step, a link between a vertex that crossed and one that did not leads around a border. Then the
/// crossings of linked vertices that crossed alike count only if they have no link to others, or if the border is out
/// of reach for one of them.
std::vector<int> proven_crossings(std::span<const double> from, std::span<const double> to, const TriangleMeshView&,
                                  const TriangleTree&, std::span<const Link> links);

}  // namespace clothbench::contact

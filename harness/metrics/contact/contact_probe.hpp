#pragma once
#include <optional>
#include <span>
#include <vector>

#include "metrics/contact/triangle_mesh.hpp"

namespace clothbench::contact {

/// Contact of a cloth with one object at one instant. Both are NaN if the cloth is not finite.
struct ContactSample {
  double contour_length_m;  ///< of the intersection contour of cloth and object
  double depth_max_m;       ///< of the cloth in the object, also between vertices; NaN for an object without inside
};

/// Contact with a mesh as it is: the contour is exact (`contour`), the depth is the largest distance from the surface
/// of all vertices, edge midpoints and centroids that are inside. Vertices only would miss a finger that comes up
/// through the middle of a triangle. A mesh with an inside is closed, normals outward. `links`: edges_of the cloth.
ContactSample mesh_contact(const TriangleMeshView& cloth, std::span<const Link> links, const TriangleTree& mesh,
                           bool has_inside);

/// Contact with capsules, whose radii are positive. They are triangles for the contour (capsule_mesh), which is at most
/// kCapsuleError of the radius too far inside; segments inside another capsule are left out. The depth is exact, in any
/// single capsule.
ContactSample capsule_contact(const TriangleMeshView& cloth, std::span<const Capsule> shapes);

/// Contact of a cloth with the half-space behind a plane, opposite to its unit normal. Exact: depth is linear on a flat
/// triangle, so its contour is one straight cut, and its deepest point is a vertex.
ContactSample half_space_contact(const TriangleMeshView& cloth, const Point<3>& on_plane, const Point<3>& normal);

/// How much of a cloth intersects an object at one instant. Needs no history or orientation, so open meshes work too.
struct Contour {
  double length_m = 0;  ///< of the intersection contour of the two surfaces
  long pairs = 0;       ///< (cloth triangle, object triangle) with a point in common, exactly
};

/// The segment in which two triangles in general position cross; none if they do not.
std::optional<std::array<Point<3>, 2>> intersection(const Simplex<3>& cloth, const Simplex<3>& object);

/// Where a cloth crosses an object.
///
/// The length is summed over pairs of triangles; it is the quantity minimised by Volino & Magnenat-Thalmann (Resolving
/// surface collisions through intersection contour minimization, 2006). In degenerate configurations it is the length
/// for the cloth translated by (e, e^2, e^3), e -> 0+ (crossing): a piece of the curve along an edge shared by
/// triangles counts once, and coplanar triangles do not cross. Touching pairs, including coplanar ones, count once as
/// pairs, with no length. Triangles of zero area are ignored: their neighbours contain the same points. The cloth must
/// be finite.
Contour contour(const TriangleMeshView& cloth, const TriangleTree& object);

/// Where a cloth crosses itself: pairs of its triangles that share no vertex, each once. Every self-intersection begins
/// with an edge that passes through a face not containing it, or with two edges that pass each other. So only a crease
/// turned inside out within the triangles of one vertex is missed. Otherwise as above.
Contour self_contour(const TriangleMeshView& cloth);

/// Signed crossings of the straight path p -> q with a static mesh: those along the normals minus those against. Exact
/// (crossing): a path through a common edge or vertex, or that ends on the surface, counts once.
int signed_crossings(const Point<3>& p, const Point<3>& q, const TriangleTree& mesh);

/// Whether a point is inside a closed mesh with outward normals: signed crossings of a ray are positive. Exact.
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
/// crossings of linked vertices that crossed alike count only without a link to others or with the border out of reach.
std::vector<int> proven_crossings(std::span<const double> from, std::span<const double> to, const TriangleMeshView&,
                                  const TriangleTree&, std::span<const Link> links);

}  // namespace clothbench::contact

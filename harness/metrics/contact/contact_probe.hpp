#pragma once
#include <optional>
#include <span>
#include <vector>

#include "metrics/contact/triangle_mesh.hpp"

namespace clothbench::contact {

/// Contact of a cloth with one object at one instant. Both values are NaN if the cloth is not finite.
struct ContactSample {
  double contour_length_m;  ///< length of the intersection contour of cloth and object
  double depth_max_m;       ///< largest depth of the cloth, not only of vertices; NaN if the object has no inside
};

/// Contact with a mesh. The contour is exact (`contour`). The depth is the largest distance to the mesh's surface, over
/// the cloth's vertices, edge midpoints and centroids inside; vertices only would miss a finger that rises through the
/// middle of a triangle. A mesh with an inside is closed, with outward normals. `links`: edges_of the cloth.
ContactSample mesh_contact(const TriangleMeshView& cloth, std::span<const Link> links, const TriangleTree& mesh,
                           bool has_inside);

/// Contact with capsules of positive radius. Their contour is computed on triangles (capsule_mesh), which lie at most
/// kCapsuleError times the radius below the surface; contour inside another capsule does not count. The depth is exact:
/// the largest depth in a single capsule.
ContactSample capsule_contact(const TriangleMeshView& cloth, std::span<const Capsule> shapes);

/// Contact of a cloth with the half-space behind a plane, opposite to its unit normal. Exact: depth is linear on a flat
/// triangle, so its contour is one straight segment, and its deepest point is a vertex.
ContactSample half_space_contact(const TriangleMeshView& cloth, const Point<3>& on_plane, const Point<3>& normal);

/// How much of a cloth intersects an object at one instant. Needs no history or orientation, so open meshes work too.
struct Contour {
  double length_m = 0;  ///< of the intersection contour of the two surfaces
  long pairs = 0;       ///< (cloth triangle, object triangle) with a common point; exact
};

/// The segment in which two triangles in general position cross; none if they do not.
std::optional<std::array<Point<3>, 2>> intersection(const Simplex<3>& cloth, const Simplex<3>& object);

/// Intersection of a cloth with an object.
///
/// The length is summed over pairs of triangles; it is the quantity minimised by Volino & Magnenat-Thalmann (Resolving
/// surface collisions through intersection contour minimization, 2006). In degenerate configurations it is the length
/// for the cloth translated by (e, e^2, e^3), e -> 0+ (crossing): a part of the curve along an edge shared by triangles
/// counts once, and coplanar triangles do not cross. A touching pair, coplanar ones included, counts once as a pair,
/// with no length. Triangles of zero area are ignored: their neighbours contain the same points. The cloth must be
/// finite.
Contour contour(const TriangleMeshView& cloth, const TriangleTree& object);

/// Intersection of a cloth with itself: pairs of its triangles that share no vertex, each once. Every self-intersection
/// begins with an edge that passes through a face not containing it, or with two edges that pass each other. Only
/// a crease turned inside out within the triangles of one vertex is missed. Degenerate cases as in `contour`.
Contour self_contour(const TriangleMeshView& cloth);

/// Signed crossings of the straight path p -> q with a static mesh: crossings along the normals minus crossings against
/// them. Exact (crossing): a path through a common edge or vertex, or one that ends on the surface, crosses once.
int signed_crossings(const Point<3>& p, const Point<3>& q, const TriangleTree& mesh);

/// Whether a point is inside a closed mesh with outward normals: its ray has positive signed crossings. Exact.
bool is_inside(const Point<3>& p, const TriangleTree& mesh);

/// A mesh whose vertices move from `from` to `to` during one step.
///
/// The cloth's vertex and the mesh both move, so the crossing is computed in space-time. There the path is a straight
/// segment, and each moving triangle sweeps a prism that is cut into three tetrahedra (staircase over the vertex order,
/// so that neighbours cut their common wall alike). Cutting replaces the linear motion inside a triangle by a piecewise
/// linear one with the same start and end. Both motions have the same sum of signed crossings if the path does not
/// cross the moving border of an open mesh: the volume between the two surfaces is empty at start and end, so a path
/// that enters it also leaves it. The orientation tests are exact; no root is computed.
class SweptMesh {
 public:
  /// `from` and `to` have equal triangles; `welded` is welded_vertices(from), so that repeated vertices share walls.
  SweptMesh(const TriangleMeshView& from, const TriangleMeshView& to, std::span<const std::uint32_t> welded);

  /// Signed crossings of the path from p, with the mesh at `from`, to q, with the mesh at `to`.
  int signed_crossings(const Point<3>& p, const Point<3>& q) const;

 private:
  struct Prism {
    Simplex<3> from, to;  ///< corners in vertex order
    int orientation;      ///< -1 if that order reverses the normal
  };
  std::vector<Prism> prisms_;
  BoxTree tree_;
};

/// Signed crossings of each vertex of a cloth that moves past a static mesh in one step. `links` join neighbouring
/// vertices; without links every crossing counts.
///
/// The straight path between frames may cross a mesh that the vertex moved around. If no link crosses the mesh before
/// or after the step, a link from a vertex that crossed to one that did not passes around a border. A connected group
/// of vertices with equal crossings then counts only if it has no link to others, or a member cannot reach the border.
std::vector<int> proven_crossings(std::span<const double> from, std::span<const double> to, const TriangleMeshView&,
                                  const TriangleTree&, std::span<const Link> links);

}  // namespace clothbench::contact

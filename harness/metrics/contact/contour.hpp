#pragma once
#include <optional>

#include "metrics/contact/triangle_mesh.hpp"

namespace clothbench::contact {

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
/// for the cloth translated by (e, e^2, e^3), e -> 0+ (predicates.hpp): a piece of the curve along an edge shared by
/// triangles counts once, not once for each of them, and coplanar triangles do not cross. Touching pairs, including
/// coplanar ones, count once as pairs, with no length. Triangles of zero area, on either side, are ignored: their
/// neighbours contain the same points.
/// The cloth must be finite.
Contour contour(const TriangleMeshView& cloth, const TriangleTree& object);

/// Where a cloth crosses itself: pairs of its triangles that share no vertex, each once. Every self-intersection begins
/// with an edge that passes through a face not containing it, or with two edges that pass each other. So only a crease
/// turned inside out within the triangles of one vertex is missed. Otherwise as above.
Contour self_contour(const TriangleMeshView& cloth);

}  // namespace clothbench::contact

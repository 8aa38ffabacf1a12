#pragma once
#include "metrics/contact/triangle_mesh.hpp"

namespace clothbench::contact {

/// How much of a cloth is in an object at one instant; without history or orientation, so for open meshes too.
struct Contour {
  double length_m = 0;       ///< of the curve in which the two surfaces cross
  long pairs = 0;            ///< (cloth triangle, object triangle) with a point in common, exactly
  long cloth_triangles = 0;  ///< cloth triangles in at least one pair
};

/// Where a cloth crosses an object.
///
/// The length is summed over pairs of triangles; it is the quantity minimised by Volino & Magnenat-Thalmann (Resolving
/// surface collisions through intersection contour minimization, 2006). In special position it is that of the cloth
/// moved by (e, e^2, e^3), e -> 0+ (predicates.hpp): a piece of the curve along an edge that triangles share counts
/// once, not once for each of them, and triangles in one plane cross nowhere. Touching pairs, those in one plane
/// among them, count as pairs, once, with no length. Triangles of no area, on either side, count nowhere: their
/// neighbours hold the same points.
/// The cloth must be finite.
Contour contour(const TriangleMeshView& cloth, const TriangleTree& object);

/// Where a cloth crosses itself: pairs of its triangles that share no vertex, each once. What crosses begins with an
/// edge that passes through a face it has no vertex of, or with two edges that pass one another, so that a crease
/// turned inside out within the triangles of one vertex is all that is left out. Otherwise as above.
Contour self_contour(const TriangleMeshView& cloth);

}  // namespace clothbench::contact

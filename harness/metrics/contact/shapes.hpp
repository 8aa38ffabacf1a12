#pragma once
#include <span>

#include "metrics/contact/contour.hpp"
#include "metrics/contact/depth.hpp"

namespace clothbench::contact {

/// All points within `radius_m` of the segment a-b; a sphere if a = b.
struct Capsule {
  Point<3> a, b;
  double radius_m;
};

inline Capsule sphere(const Point<3>& centre, double radius_m) { return {centre, centre, radius_m}; }

/// Signed distance [m] to the surface, negative inside; exact.
double signed_distance(const Point<3>& p, const Capsule&);

struct ShapesResult {
  Contour contour;           ///< pairs: (cloth triangle, capsule) that contain part of the contour
  Depth depth;               ///< in the union: the greatest depth in any single capsule
  std::vector<bool> inside;  ///< one per vertex
};

/// Contour and depth of a cloth in a union of capsules, from their signed distance instead of a tessellation.
///
/// Each edge of a cloth triangle is halved until no edge is longer than `resolution_m`. A part is discarded as soon as
/// the distance at its centre proves it outside (the distance is 1-Lipschitz). A part at the contour is halved up to
/// six times more, until its contour changes by less than 0.5 %. In the smallest parts the distance is taken as linear,
/// so the errors of area and mean are quadratic in the resolution. At most kMaxHalvings subdivisions to the resolution
/// bound the work for a cloth that has been torn apart.
///
/// The greatest depth is exact: the radius less the distance between a triangle and the capsule's segment. The contour
/// with a sphere alone is exact too: arcs of circles (contour_with_sphere). A contour with capsules that fits between
/// the corners of the last parts, shorter than a hundredth of the radius, may be missed.
ShapesResult shapes_contact(const TriangleMeshView& cloth, std::span<const Capsule> shapes, double resolution_m);
inline constexpr int kMaxHalvings = 7;

/// Length [m] of the curve in which a triangle and a sphere (a capsule with a = b) cross, in closed form.
double contour_with_sphere(const Simplex<3>& triangle, const Capsule& sphere);

/// An eighth of the smallest radius.
double default_resolution_m(std::span<const Capsule> shapes);

}  // namespace clothbench::contact

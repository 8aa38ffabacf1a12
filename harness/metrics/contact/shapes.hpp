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
/// the distance at its centre proves it outside (the distance is 1-Lipschitz). In the smallest parts the distance is
/// taken as linear, so the errors of length, area and mean are quadratic in the resolution. Every corner and centre
/// evaluated is a sample for the maximum, including the points of MeshDepth. At most kMaxHalvings subdivisions bound
/// the work for a cloth that has been torn apart.
ShapesResult shapes_contact(const TriangleMeshView& cloth, std::span<const Capsule> shapes, double resolution_m);
inline constexpr int kMaxHalvings = 7;

/// An eighth of the smallest radius: a contour at a depth of about a tenth of the radius is short by about 1 in 300.
double default_resolution_m(std::span<const Capsule> shapes);

}  // namespace clothbench::contact

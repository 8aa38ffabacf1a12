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
  Contour contour;           ///< pairs: (cloth triangle, capsule) in which the contour runs
  Depth depth;               ///< in the union, as the greatest depth in any one capsule
  std::vector<bool> inside;  ///< one a vertex
};

/// Contour and depth of a cloth in a union of capsules, from their signed distance instead of a tessellation.
///
/// Cloth triangles are halved along each edge until no edge is longer than `resolution_m`; parts that the distance at
/// their centre (it changes no faster than one goes) proves outside are left at once. In the smallest parts the
/// distance is taken as linear, so that length, area and mean err with the square of the resolution; every corner and
/// centre met on the way is a sample for the maximum, the points of MeshDepth among them.
/// At most kMaxHalvings times, which bounds the work for a cloth that has been torn to shreds.
ShapesResult shapes_contact(const TriangleMeshView& cloth, std::span<const Capsule> shapes, double resolution_m);
inline constexpr int kMaxHalvings = 7;

/// An eighth of the least radius: a contour around a tenth of the radius deep is short by about 1 in 300.
double default_resolution_m(std::span<const Capsule> shapes);

}  // namespace clothbench::contact

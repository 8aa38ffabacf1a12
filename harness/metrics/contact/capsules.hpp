#pragma once
#include <vector>

#include "metrics/contact/triangle_mesh.hpp"

namespace clothbench::contact {

/// All points within `radius_m` of the segment a-b; a sphere if a = b.
struct Capsule {
  Point<3> a, b;
  double radius_m;
};

inline Capsule sphere(const Point<3>& centre, double radius_m) { return {centre, centre, radius_m}; }

/// Where on the axis the point nearest to p is, from 0 at a to 1 at b; 0 for a sphere.
double axis_share(const Point<3>& p, const Capsule&);

/// Signed distance [m] to the surface, negative inside; exact.
double signed_distance(const Point<3>& p, const Capsule&);

/// Triangles that have their corners on the surface of a capsule, counter-clockwise seen from outside.
struct CapsuleMesh {
  std::vector<double> positions;
  std::vector<std::array<std::uint32_t, 3>> triangles;
  TriangleMeshView view() const { return {positions, triangles}; }
};

/// The triangles lie inside the capsule, so cloth outside it never crosses them. With kCapsuleSides sides around the
/// axis and a quarter of that from equator to pole, they are at most 1 - cos²(π / kCapsuleSides) of the radius below
/// the surface: kCapsuleError rounds that up.
CapsuleMesh capsule_mesh(const Capsule&);
inline constexpr int kCapsuleSides = 32;
inline constexpr double kCapsuleError = 0.01;

}  // namespace clothbench::contact

#pragma once
#include <optional>
#include <span>
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

/// The surface near a point.
struct Nearest {
  double distance_m;   ///< signed for capsules, unsigned for triangles
  Point<3> normal;     ///< unit, from the surface to the point; zero where the point lies on it or on an axis
  Point<3> carried_m;  ///< displacement of that surface point since the previous frame
};

/// Nearest point of a union of capsules. `before`: the same capsules at the previous frame, as many as `now`; they may
/// turn but do not spin about their axes.
Nearest nearest(const Point<3>& p, std::span<const Capsule> now, std::span<const Capsule> before);

/// The nearest point of a mesh within `bound_m`, if there is one. `before`: the mesh at the previous frame; null if it
/// is static.
std::optional<Nearest> nearest(const Point<3>& p, const TriangleTree& mesh, double bound_m,
                               const TriangleMeshView* before = nullptr);

/// Whether a triangle has a point at most `reach_m` from a mesh.
bool within(const Simplex<3>& triangle, const TriangleTree& mesh, double reach_m);

/// Corner weights of the point of a triangle with area that is nearest to p; they are never negative and sum to 1
/// (Ericson, Real-Time Collision Detection, 5.1.5).
Point<3> nearest_weights(const Point<3>& p, const Simplex<3>& triangle);

/// Squared distance [m2] between the segments a-b and c-d (Ericson, Real-Time Collision Detection, 5.1.9).
double squared_distance(const Point<3>& a, const Point<3>& b, const Point<3>& c, const Point<3>& d);

/// Squared distance [m2] between the segment a-b and a triangle: 0 if they cross.
double squared_distance(const Point<3>& a, const Point<3>& b, const Simplex<3>& triangle);

/// Whether a triangle has a point at most `reach_m` from the surface of a capsule, or inside the capsule.
bool within(const Simplex<3>& triangle, const Capsule&, double reach_m);

/// Whether two triangles have points at most `reach_m` apart.
bool within(const Simplex<3>& triangle, const Simplex<3>& other, double reach_m);

}  // namespace clothbench::contact

#pragma once
#include <optional>
#include <span>

#include "metrics/contact/capsules.hpp"
#include "metrics/contact/triangle_mesh.hpp"

namespace clothbench::contact {

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

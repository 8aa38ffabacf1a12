#pragma once
#include <optional>
#include <span>
#include <vector>

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

/// A triangle mesh for nearest-point queries within a bound. The views' arrays must outlive it.
class NearSurface {
 public:
  explicit NearSurface(const TriangleMeshView& now);

  /// The nearest point within `bound_m`, if there is one. `before`: positions at the previous frame; empty if the mesh
  /// is static.
  std::optional<Nearest> operator()(const Point<3>& p, double bound_m, std::span<const double> before = {}) const;

  /// Whether a triangle has a point at most `reach_m` from the mesh.
  bool within(const Simplex<3>& triangle, double reach_m) const;

 private:
  TriangleMeshView mesh_;
  std::vector<std::size_t> source_;  ///< indices in the mesh of the triangles with area
  BoxTree tree_;
};

/// Corner weights of the point of a triangle with area that is nearest to p; they are never negative and sum to 1
/// (Ericson, Real-Time Collision Detection, 5.1.5).
Point<3> nearest_weights(const Point<3>& p, const Simplex<3>& triangle);

}  // namespace clothbench::contact

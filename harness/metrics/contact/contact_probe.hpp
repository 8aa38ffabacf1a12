#pragma once
#include <memory>
#include <span>

#include "metrics/contact/capsules.hpp"
#include "metrics/contact/triangle_mesh.hpp"

namespace clothbench::contact {

/// Contact of a cloth with one object at one instant. Both are NaN if the cloth is not finite.
struct ContactSample {
  double contour_length_m;  ///< of the intersection contour of cloth and object
  double depth_max_m;       ///< of the cloth in the object, also between vertices; NaN for an object without inside
};

/// Whether a mesh has an inside.
enum class Solid {
  Auto,    ///< if no edge is open
  Nearly,  ///< yes, despite holes (a hand open at the wrist); decided by the generalised winding number
  No       ///< no: depth is NaN
};

/// Measures contact of one cloth with one object, frame after frame. Frames do not depend on each other.
///
/// A mesh is taken as it is: the contour is exact (contour.hpp), the depth is the largest distance from the surface of
/// all vertices, edge midpoints and centroids that are inside. Vertices only would miss a finger that comes up through
/// the middle of a triangle. Capsules are triangles for the contour (capsule_mesh), which is at most kCapsuleError of
/// the radius too far inside; what lies inside another capsule of the same object is left out. Their depth is exact: of
/// the deepest point of a triangle in any single capsule.
class ContactProbe {
 public:
  /// Copies all the data it needs. Throws Error for bad indices, numbers that are not finite, or a cloth without area.
  ContactProbe(const TriangleMeshView& cloth_at_rest, const TriangleMeshView& object, Solid solid = Solid::Auto);
  /// As above; radii must be positive.
  ContactProbe(const TriangleMeshView& cloth_at_rest, std::span<const Capsule> shapes);
  ~ContactProbe();
  ContactProbe(ContactProbe&&) noexcept;
  ContactProbe& operator=(ContactProbe&&) noexcept;

  /// Sets the object's pose. Throws Error for a different number of vertices (capsules), or numbers that are not
  /// finite.
  void move_object(std::span<const double> positions);
  void move_shapes(std::span<const Capsule> shapes);

  /// Positions xyz interleaved, as many as at rest (otherwise Error).
  ContactSample probe(std::span<const double> cloth_positions) const;

  /// Whether depth is defined.
  bool has_inside() const;

 private:
  struct State;
  std::unique_ptr<State> state_;
};

/// Contact of a cloth with the half-space behind a plane, opposite to its unit normal. Exact: depth is linear on a flat
/// triangle, so its contour is one straight cut, and its deepest point is a vertex.
ContactSample half_space_contact(const TriangleMeshView& cloth, const Point<3>& on_plane, const Point<3>& normal);

}  // namespace clothbench::contact

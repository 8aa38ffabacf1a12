#pragma once
#include <memory>
#include <span>

#include "metrics/contact/shapes.hpp"
#include "metrics/contact/triangle_mesh.hpp"

namespace clothbench::contact {

/// One frame's figures. All are NaN if the cloth isn't finite. `depth` and `area` are NaN for an open object, which
/// has no inside.
struct ContactSample {
  double contour_length_m;       ///< of the curve in which cloth and object cross
  double pairs;                  ///< intersecting (cloth triangle, object triangle or capsule)
  double cloth_fraction;         ///< share of cloth triangles that are in a pair
  double tunnelled_fraction;     ///< share of the rest area that is on the other side than at the start
  double tunnelled_depth_max_m;  ///< greatest distance of a tunnelled vertex from the object; 0 if there is none
  double depth_max_m;            ///< over all sample points
  double depth_vertex_max_m;     ///< over the vertices alone
  double depth_p99_m;            ///< 99 % of the penetrating area is no deeper
  double depth_mean_m;           ///< over the penetrating area
  double area_m2;                ///< penetrating area
  double area_fraction;          ///< of the cloth's current (deformed) area
};

/// Whether a mesh has an inside.
enum class Solid {
  Auto,    ///< if no edge is open
  Nearly,  ///< yes, despite holes (a hand open at the wrist); decided by the generalised winding number
  No       ///< no: depth and area are NaN
};

/// Tracks the contact of one cloth with one object, frame after frame.
///
/// Crossings are counted from one probe to the next. The sequence starts at the first probe after construction or a
/// reset, where nothing has tunnelled. After a state that is not finite the history is unknown, and the tunnelled
/// fraction is NaN until a reset. Capsules are convex and closed and need no history: their tunnelled vertices are
/// those inside.
class ContactProbe {
 public:
  /// The cloth's rest positions give each vertex its share of area. Copies all the data it needs. Throws Error for bad
  /// indices, numbers that are not finite, or a cloth without area.
  ContactProbe(const TriangleMeshView& cloth_at_rest, const TriangleMeshView& object, Solid solid = Solid::Auto);
  /// As above; radii must be positive.
  ContactProbe(const TriangleMeshView& cloth_at_rest, std::span<const Capsule> shapes);
  ~ContactProbe();
  ContactProbe(ContactProbe&&) noexcept;
  ContactProbe& operator=(ContactProbe&&) noexcept;

  /// Sets the object's pose at the next probe. Its vertices move in straight lines from their positions at the last
  /// probe. Throws Error for a different number of vertices (capsules), or numbers that are not finite.
  void move_object(std::span<const double> positions);
  void move_shapes(std::span<const Capsule> shapes);

  /// Positions xyz interleaved, as many as at rest (else Error).
  ContactSample probe(std::span<const double> cloth_positions);

  /// Forgets the history.
  void reset();

  /// Signed crossing count of each vertex; empty for capsules.
  std::span<const int> crossing_counts() const;
  /// Whether depth is defined.
  bool has_inside() const;

 private:
  struct State;
  std::unique_ptr<State> state_;
};

}  // namespace clothbench::contact

#pragma once
#include <memory>
#include <span>
#include <vector>

#include "metrics/motion_check/motion.hpp"

namespace clothbench::motion_check {

/// A point at which a collider may exert force on the cloth in a frame.
struct Contact {
  V3 point, normal;  ///< of the collider's surface, outwards
  double friction;
  bool any_force;  ///< the collider moves by much of its own size: no direction is known
};

/// The surface within reach of the cloth in one frame.
struct Face {
  bool any = false;  ///< something is in reach
  bool flat = true;  ///< all of it is static and has one normal and one friction
  V3 normal = V3::Zero();
  double friction = 0;
  void add(const V3& n, double mu);
};

/// The colliders of the scene, frame after frame.
class Bodies {
 public:
  Bodies(const Motion&, std::span<const double> contact_offsets_m);
  ~Bodies();
  Bodies(const Bodies&) = delete;
  Bodies& operator=(const Bodies&) = delete;

  bool empty() const;
  bool any_moves() const;
  /// Highest speed [m/s] of a collider between two frames, jumps included.
  double speed() const;
  /// Where the cloth of a frame is within reach of a collider; the reach grows with the displacements next to the
  /// frame.
  const std::vector<Contact>& contacts(std::size_t frame);
  /// Whether a vertex, or a triangle at it, was within reach of a collider in a frame, as found by `contacts`.
  bool touched(std::size_t frame, std::size_t vertex) const;
  /// Surface in reach in a frame, as found by `contacts`.
  const Face& face(std::size_t frame) const;
  /// Largest depth of a frame over its tolerance: of vertices in solids with a signed distance.
  double depth_ratio(std::size_t frame) const;
  /// Whether `points` [m], moved by at most `displacement_m`, may touch a collider in a frame.
  bool near(std::size_t frame, std::span<const V3> points, double displacement_m) const;
  /// Points inside colliders that pass the cloth, and vertices that pass a static surface, between a frame and the one
  /// before it.
  int passages(std::size_t frame) const;

 private:
  struct State;
  std::unique_ptr<State> state_;
};

}  // namespace clothbench::motion_check

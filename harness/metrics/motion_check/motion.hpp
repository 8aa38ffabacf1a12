#pragma once
#include <Eigen/Dense>
#include <array>
#include <cmath>
#include <memory>
#include <span>
#include <vector>

#include "metrics/motion_check/motion_check.hpp"

namespace clothbench::motion_check {

using V3 = Eigen::Vector3d;

inline V3 to_v3(const Vec3& v) { return {v[0], v[1], v[2]}; }

/// Fraction of the cloth's longer side below which displacements are not evaluated.
inline constexpr double kResolution = 1e-4;

/// Free flight with linear damping c around a stored frame. Displacements: before, a1 v + b1 g; after, a2 v + b2 g.
struct Flight {
  double a1, b1, a2, b2;
  Flight(double before_s, double after_s, double c);
  double unit() const { return b2 - a2 / a1 * b1; }
  /// Acceleration [m/s2] beyond gravity and damping, from the displacements before and after the frame.
  V3 unexplained(const V3& behind, const V3& ahead, const V3& gravity) const {
    return (ahead - a2 / a1 * behind) / unit() - gravity;
  }
};

/// A stored motion with the scene's data that the checks need.
class Motion {
 public:
  Motion(const Scene& scene, const Frames& frames);

  const Scene& scene;
  std::size_t vertices, frames;
  std::vector<double> masses_kg;
  double mass_kg = 0;       ///< mass of the cloth
  double length_m = 0;      ///< longer side of the cloth
  double cell_m = 0;        ///< mean edge length along u or v, whichever is longer
  double resolution_m = 0;  ///< kResolution of the longer side
  V3 gravity{};             ///< [m/s2]
  double weight_unit = 0;   ///< |gravity| [m/s2]; 9.81 if the scene has none
  std::vector<Edge> edges;  ///< structural
  std::vector<std::array<std::uint32_t, 3>> triangles;
  std::vector<double> start_velocity;  ///< [m/s] xyz interleaved
  double start_speed = 0;              ///< maximum of them [m/s]
  double grip_speed = 0;               ///< [m/s] maximum of an attachment between two frames, jumps included

  V3 at(std::size_t frame, std::size_t vertex) const {
    const float* x = position_.data() + 3 * (frame * vertices + vertex);
    return {x[0], x[1], x[2]};
  }
  double time_s(std::size_t frame) const { return time_s_[frame]; }
  /// Duration [s] of the interval before a frame; for frame 0, the interval after it.
  double dt(std::size_t frame) const {
    return frame == 0 ? (frames > 1 ? time_s_[1] - time_s_[0] : scene.time.dt()) : time_s_[frame] - time_s_[frame - 1];
  }
  V3 start_velocity_of(std::size_t vertex) const { return V3::Map(start_velocity.data() + 3 * vertex); }
  /// Strain of a structural edge; 0 for an edge whose rest length is 0.
  double strain(std::size_t frame, const Edge& e) const {
    return e.rest_m > 0 ? (at(frame, e.b) - at(frame, e.a)).norm() / e.rest_m - 1 : 0;
  }
  /// Pinned vertices, and those that an attachment holds at the end of a frame.
  std::vector<std::uint32_t> held(std::size_t frame) const;
  /// Per vertex, whether held() contains it.
  std::vector<bool> is_held(std::size_t frame) const;
  bool has_attachments() const { return !scene.pins.vertices.empty() || !scene.grips.vertices.empty(); }
  /// State of colliders and attachments in a frame, constant after the scene's end; null if only cloth moves.
  const FrameMotion* scripted(std::size_t frame) const;
  /// Acceleration [weights] from position errors of one resolution, averaged over `count` vertices.
  double noise(std::size_t frame, std::size_t count) const {
    const double t = dt(frame);
    return 15 * resolution_m / std::sqrt(static_cast<double>(count)) / (t * t * weight_unit);
  }

 private:
  std::span<const double> time_s_;
  std::span<const float> position_;
};

using V6 = Eigen::Matrix<double, 6, 1>;
using M6 = Eigen::Matrix<double, 6, 6>;

/// The wrench of a force: force, and moment divided by half the cloth's length, so that both have one unit.
inline V6 wrench_of(const V3& force, const V3& arm) {
  V6 w;
  w << force, arm.cross(force);
  return w;
}

/// Projection that removes the wrenches about `middle` of vertices that are held in this, the previous or next frame.
M6 free_of_attachments(const Motion&, std::size_t frame, const V3& middle);

/// Keeps the largest ratio of each statistic.
class Findings {
 public:
  /// Lists the statistic for the run even if no frame gives it a value.
  void define(const char* name);
  /// A NaN is kept.
  void add(const char* name, double ratio, std::size_t frame);
  std::vector<Finding> take() { return std::move(found_); }

 private:
  Finding& of(const char* name);
  std::vector<Finding> found_;
};

class Bodies;

/// A group of statistics, computed in one pass over the frames.
struct Part {
  const char* name;
  void (*run)(const Motion&, Bodies&, Findings&);
};
/// All parts, in the order of the findings: later parts use the contacts that earlier parts found.
std::span<const Part> parts();

/// first_step, impulse, force, friction, sliding, mean_force, support, free_motion.
void check_momentum(const Motion&, Bodies&, Findings&);
/// hinge.
void check_hinges(const Motion&, Bodies&, Findings&);
/// energy, rise, speed, speed_change, strain, tear, compression.
void check_limits(const Motion&, Bodies&, Findings&);
/// spike, freeze, stuck.
void check_smoothness(const Motion&, Bodies&, Findings&);

/// A point at which a collider may exert force on the cloth in a frame.
struct Contact {
  V3 point, normal;  ///< of the collider's surface, outwards
  double friction;
  bool any_force;  ///< the collider moves by more than half its radius, so its force may have any direction
};

/// The surface within reach of the cloth in one frame.
struct Face {
  bool any = false;  ///< something is in reach
  bool flat = true;  ///< all of it is static, with one normal and one friction coefficient
  V3 normal = V3::Zero();
  double friction = 0;
  void add(const V3& n, double mu);
};

/// The colliders of the scene, queried frame by frame. The base class answers for a scene without colliders.
class Bodies {
 public:
  virtual ~Bodies() = default;
  virtual bool empty() const { return true; }
  virtual bool any_moves() const { return false; }
  /// Highest speed [m/s] of a collider between two frames, jumps included.
  virtual double speed() const { return 0; }
  /// Contacts in a frame: points of colliders in reach of the cloth. Reach grows with displacements around the frame.
  virtual std::span<const Contact> contacts(std::size_t /*frame*/) { return {}; }
  /// Whether a vertex or one of its triangles was within reach of a collider in a frame; call `contacts` first.
  virtual bool touched(std::size_t /*frame*/, std::size_t /*vertex*/) const { return false; }
  /// The surface in reach in a frame; call `contacts` first.
  virtual Face face(std::size_t /*frame*/) const { return {}; }
  /// Largest depth in a frame of vertices in solids with a signed distance, divided by its tolerance.
  virtual double depth_ratio(std::size_t /*frame*/) const { return 0; }
  /// Whether `points` [m], moved by at most `displacement_m`, may touch a collider in a frame.
  virtual bool near(std::size_t /*frame*/, std::span<const V3>, double /*displacement_m*/) { return false; }
  /// Passages in a frame: inner points of colliders through the cloth, and vertices through static surfaces.
  virtual int passages(std::size_t /*frame*/) { return 0; }
};
std::unique_ptr<Bodies> bodies_of(const Motion&, std::span<const double> contact_offsets_m);

}  // namespace clothbench::motion_check

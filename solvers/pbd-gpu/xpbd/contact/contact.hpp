#pragma once
#include <array>
#include <functional>
#include <vector>

#include "common/colliders.hpp"

namespace clothbench::pbd_gpu {

/// The triangles of a mesh in clusters of neighbours: at most `kClusterSize` each, every triangle in exactly one. The
/// mesh is halved recursively along the longest side of the centroids' box.
struct Clusters {
  static constexpr std::size_t kClusterSize = 16;
  std::vector<std::uint32_t> triangles;  ///< indices, cluster by cluster
  std::vector<std::uint32_t> sizes;      ///< one per cluster
};
Clusters cluster(const std::vector<double>& positions, const std::vector<std::array<std::uint32_t, 3>>& triangles);

/// Convex shapes of a scene's colliders except planes. A capsule is a segment with a radius, a sphere a point with a
/// radius. Each triangle of a box or static mesh is one shape. A kinematic mesh becomes the hulls of clusters of at
/// most Clusters::kClusterSize neighbouring triangles.
struct ConvexShapes {
  std::vector<ConvexShape> shapes;
  std::vector<ShapePoint> points;    ///< shape by shape, at the scene's start [m]
  std::vector<PointSource> sources;  ///< one per point of a kinematic convex shape
  std::vector<ShapeAabb> boxes;      ///< of the convex shapes, then of groups of SHAPES_PER_GROUP of them
  std::uint32_t max_points = 1;      ///< maximum number of points of a convex shape
  double max_margin_m = 0;
  std::vector<double> margins_m;  ///< one per collider, raised to the minimum
};
/// Positions are relative to `origin_m`.
ConvexShapes convex_shapes(const Scene& scene, Vec3 origin_m, const ColliderBuffers* colliders);

/// Contact of `xpbd` by separating planes: xpbd/contact/README.md. Works only on positions and velocities; the
/// constraint solve comes between `record_before` and `record_after` and reads inverse masses in .w of the positions.
/// If a FusedFrame simulates the frame, only `record_shapes` is called.
class XpbdContact {
 public:
  /// The largest displacement of a vertex during a list of pairs [m], and the largest strain of a link at its end.
  struct Measured {
    double displacement_m, strain;
  };

  /// Adds buffers, and the kernel that updates kinematic shapes. `particle[v]`: the vertex that vertex v is welded to,
  /// or v; empty: no welds. `colliders`: null if the scene has none. `second_solve`: constraints are also solved
  /// between the response rounds. `growth`: factor on the capacities of the lists of self-contact.
  XpbdContact(FrameBuilder& frame, const Scene& scene, Vec3 origin_m, const ColliderBuffers* colliders,
              const std::vector<std::uint32_t>& particle, bool second_solve, std::uint32_t growth);
  /// Adds one kernel per pass, for record_list, record_before and record_after.
  void add_kernels();

  /// Records the update of kinematic shapes' points and boxes. Call at a frame's start, after the colliders' record().
  void record_shapes(double dt_s, int substeps);
  /// Records the broad phase. Call after record_shapes.
  void record_list(double dt_s, int substeps);
  /// Records the passes before the solve of substep s. Call after attached vertices have moved.
  void record_before(int s, int substeps, double dt_s);
  /// Records the passes after the solve of substep s. Calls `constraints` between the response rounds.
  void record_after(int s, int substeps, double dt_s, const std::function<void()>& constraints);
  /// Adds the kernel that measures the largest displacement and strain. `particle`: as in the constructor.
  void add_measurement(const std::vector<std::uint32_t>& particle);
  /// Records the measurement. Call after the last substep of a list.
  void record_measurement();

  FeatureSet serves() const;
  bool with_itself() const { return with_itself_; }
  /// Specialization constants of the scene, for the fused kernel.
  const ContactSpecialization& specialization() const { return constants_; }
  ContactConstants constants(int s, int substeps, double dt_s) const;

  /// Diagnostics since loading or set_diagnostics(); xpbd/contact/README.md says what each count means.
  ContactDiagnostics diagnostics() const;
  void set_diagnostics(const ContactDiagnostics&);
  /// Reads and resets what was measured since the last call.
  Measured read_measured();
  bool has_kinematic_shapes() const { return kinematic_points_ > 0; }
  /// What one frame leaves for the next, apart from positions and velocities.
  const vulkan::Buffer& frame_state() const { return *frame_state_; }

 private:
  /// A kernel, its number of workgroups, and ContactConstants::level. A Phase is a sequence of passes.
  struct Pass {
    const FrameKernel* kernel;
    vulkan::Groups groups;
    std::uint32_t level = 0;
  };
  using Phase = std::vector<Pass>;
  Pass pass(int stage, const char* name, std::uint64_t items, std::uint32_t threads = kGroupSize);
  void set_lengths(const ConvexShapes&);
  void add_primitives(const std::vector<std::uint32_t>& particle);
  void add_self_pairs(const std::vector<std::uint32_t>& particle, std::uint32_t growth);
  void run(const Phase&, ContactConstants);

  FrameBuilder& frame_;
  const Scene& scene_;
  const bool with_itself_;
  ContactSpecialization constants_;
  ContactPassSpecialization pass_constants_;  ///< if each pass has its own kernel
  std::uint32_t kinematic_points_ = 0;
  int stage_pairs_ = -1;
  bool holds_all_pairs_ = false;  ///< the list of candidate pairs cannot overflow
  const vulkan::Buffer *diagnostics_ = nullptr, *frame_state_ = nullptr;
  Phase update_shapes_, list_, before_, first_round_, later_round_, end_, measure_;
};

}  // namespace clothbench::pbd_gpu

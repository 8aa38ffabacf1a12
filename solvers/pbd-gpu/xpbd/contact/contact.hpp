#pragma once
#include <functional>
#include <memory>
#include <vector>

#include "common/colliders.hpp"
#include "xpbd/contact/convex_shapes.hpp"

namespace clothbench::pbd_gpu {

/// The cloth's pairs with itself in contact by separating planes (xpbd/contact/README.md): triangles without a common
/// vertex. XpbdContact has the phases of vertices, and calls these between them.
class SelfContactKernels {
 public:
  /// Adds buffers. `particle`: of each vertex, the vertex that it is welded to; empty: itself.
  SelfContactKernels(FrameBuilder& frame, const Scene& scene, const std::vector<std::uint32_t>& particle);
  void add_list_kernels(int stage, ContactSpecialization);
  void add_kernels(int stage, const std::vector<std::uint32_t>& constants);

  /// Specialization constants of all kernels of contact by separating planes.
  void specialize(ContactSpecialization& s) const {
    s.SELF = 1;
    s.SELF_CAPACITY = capacity_;
    s.ACTIVE_CAPACITY = active_capacity_;
    s.CONTACT_CAPACITY = contact_capacity_;
    s.THICKNESS_BITS = thickness_bits_;
    s.SELF_FRICTION_BITS = friction_bits_;
  }

  void record_list(const ContactConstants&);
  /// Nearest points and a round of responses, before the lines (round 0) and after them (turn 1).
  void record_query(const ContactConstants&);
  void record_response(const ContactConstants&);
  void record_planes(const ContactConstants&);

 private:
  const FrameKernel* add(int stage, const char* name, const std::vector<std::uint32_t>& constants,
                         std::uint32_t threads = kGroupSize);
  void active_pairs(const FrameKernel* kernel, const ContactConstants&);

  FrameBuilder& frame_;
  std::uint32_t triangles_ = 0, capacity_ = 0, active_capacity_ = 0, contact_capacity_ = 0, thickness_bits_ = 0,
                friction_bits_ = 0;
  std::uint32_t lanes_per_triangle_ = 1;  ///< threads that share a triangle's list: a subgroup
  const vulkan::Buffer* ranges_ = nullptr;
  const FrameKernel *boxes_ = nullptr, *count_ = nullptr, *scan_ = nullptr, *fill_ = nullptr,
                    *displacement_kernel_ = nullptr, *active_pairs_ = nullptr, *nearest_points_ = nullptr,
                    *respond_ = nullptr, *select_plane_ = nullptr;
};

/// Contact of `xpbd` by separating planes: xpbd/contact/README.md. Every pair of a triangle of the cloth and a convex
/// convex shape of a collider that may meet in a substep has a plane that separates both ends of the straight
/// displacement, and no vertex ends a substep behind a plane of one of its triangles. Works on positions and velocities
/// alone; what solves the constraints comes between `record_before` and `record_after` and reads inverse masses in .w
/// of the positions. Where FusedFrame has the frame in one dispatch in one kernel, only `record_shapes` is called.
class XpbdContact {
 public:
  /// Adds buffers, and what kinematic convex shapes need. `particle`: of each vertex, the vertex that it is welded to
  /// (or itself). `colliders`: null if the scene has none. `again`: the constraints are solved once more between the
  /// responses.
  XpbdContact(FrameBuilder& frame, const Scene& scene, Vec3 origin_m, const ColliderBuffers* colliders,
              const std::vector<std::uint32_t>& particle, bool again);
  /// Adds the stages ContactBroadPhase and XpbdContact with one kernel per pass, for record_list, record_before and
  /// record_after.
  void add_kernels();

  /// Where kinematic convex shapes are in this frame. Call at the start of a frame, after the colliders' record().
  void record_shapes(double dt_s, int substeps);
  /// The list of pairs. Call after record_shapes.
  void record_list(double dt_s, int substeps);
  /// Call in substep s after attached vertices have moved and before the constraints are solved.
  void record_before(int s, int substeps, double dt_s);
  /// Call at the end of substep s. Calls `constraints` to record them once more between the responses, if they are to
  /// be solved again.
  void record_after(int s, int substeps, double dt_s, const std::function<void()>& constraints);

  FeatureSet serves() const;
  bool with_itself() const { return self_ != nullptr; }
  /// What the kernel of a frame in one dispatch needs of the scene.
  FusedFrameSpecialization frame_specialization() const;
  ContactConstants constants(int s, int substeps, double dt_s) const;

  /// What went wrong since loading or clear_diagnostics(); xpbd/contact/README.md says what each count means.
  ContactDiagnostics diagnostics() const;
  void clear_diagnostics();
  /// Maximum displacement of a vertex in the last frame [m]; infinite if it had no contact. Call before each
  /// frame.
  double read_max_displacement_m(bool is_single_dispatch);
  bool has_kinematic_shapes() const { return kinematic_points_ > 0; }

 private:
  const FrameKernel* add(int stage, const char* name, std::uint32_t threads = kGroupSize);
  void add_primitives(const std::vector<std::uint32_t>& particle);
  ContactSpecialization specialization() const;
  void vertices(const FrameKernel* kernel, const ContactConstants& c);
  void shared_vertices(const FrameKernel* kernel, const ContactConstants& c);
  void pairs(const FrameKernel* kernel, const ContactConstants& c);

  FrameBuilder& frame_;
  const Scene& scene_;
  const bool second_solve_;
  const std::uint32_t half_spaces_;
  std::unique_ptr<SelfContactKernels> self_;  ///< if the cloth touches itself
  std::uint32_t lanes_per_vertex_ = 1;        ///< lanes that share a vertex
  std::uint32_t triangles_ = 0, shapes_ = 0, groups_ = 0, kinematic_points_ = 0, capacity_ = 0, max_points_ = 1;
  double max_margin_m_ = 0;
  int stage_pairs_ = -1, stage_ = -1;
  const vulkan::Buffer* diagnostics_ = nullptr;
  const FrameKernel *update_shapes_ = nullptr, *bounds_ = nullptr, *count_ = nullptr, *scan_ = nullptr,
                    *fill_ = nullptr, *predict_ = nullptr, *active_pairs_ = nullptr, *nearest_points_ = nullptr,
                    *accumulate_ = nullptr, *clamp_ = nullptr, *respond_ = nullptr, *select_plane_ = nullptr,
                    *project_ = nullptr;
};

}  // namespace clothbench::pbd_gpu

#pragma once
#include <functional>
#include <memory>
#include <vector>

#include "colliders.hpp"
#include "contact_pieces.hpp"
#include "plane_self.hpp"

namespace clothbench::pbd_gpu {

/// Contact of `xpbd` by separating planes: PLANES.md. Every pair of a triangle of the cloth and a convex
/// piece of a collider that may meet in a substep has a plane that parts both ends of the straight way, and no vertex
/// ends a substep behind a plane of one of its triangles. Works on positions and velocities alone;
/// what solves the constraints comes between `record_before` and `record_after` and reads inverse masses in .w of the
/// positions. Where PlaneFrame has the whole frame in one kernel, only `record_pieces` is called.
class PlaneContact {
 public:
  /// Adds buffers, and what moving pieces need. `particle`: of each vertex, the vertex that it is welded to (or
  /// itself).
  /// `colliders`: null if the scene has none. `again`: the constraints are solved once more between the responses.
  PlaneContact(FrameBuilder& frame, const Scene& scene, Vec3 origin_m, const ColliderBuffers* colliders,
               const std::vector<std::uint32_t>& particle, bool again);
  /// Adds the stages PlanePairs and PlaneContact with a kernel a phase, for record_list, record_before and
  /// record_after.
  void add_kernels();

  /// Where moving pieces are in this frame. Call at the start of a frame, after the colliders' record().
  void record_pieces(double dt_s, int substeps);
  /// The list of pairs. Call after record_pieces.
  void record_list(double dt_s, int substeps);
  /// Call in substep s after held vertices have moved and before the constraints are solved.
  void record_before(int s, int substeps, double dt_s);
  /// Call at the end of substep s. Calls `constraints` to record them once more between the responses, if they are to
  /// be solved again.
  void record_after(int s, int substeps, double dt_s, const std::function<void()>& constraints);

  FeatureSet serves() const;
  bool with_itself() const { return self_ != nullptr; }
  /// What the kernel of a whole frame needs of the scene.
  PlaneFrameSpecialization frame_specialization() const;
  PlaneContactConstants constants(int s, int substeps, double dt_s) const;

  /// What went wrong since loading or clear_faults(); PLANES.md says what each count means.
  ContactFaults faults() const;
  void clear_faults();
  /// Greatest displacement of a vertex in the last frame [m]; infinite if it had no contact. Call before each
  /// frame.
  double take_farthest_m(bool whole_frame);
  bool moves() const { return moving_points_ > 0; }

 private:
  const FrameKernel* add(int stage, const char* name, std::uint32_t threads = kGroupSize);
  void add_elements(const std::vector<std::uint32_t>& particle);
  PlaneContactSpecialization specialization() const;
  void vertices(const FrameKernel* kernel, const PlaneContactConstants& c);
  void shared_vertices(const FrameKernel* kernel, const PlaneContactConstants& c);
  void pairs(const FrameKernel* kernel, const PlaneContactConstants& c);

  FrameBuilder& frame_;
  const Scene& scene_;
  const bool again_;
  const std::uint32_t half_spaces_;
  std::unique_ptr<PlaneSelf> self_;  ///< if the cloth touches itself
  std::uint32_t team_ = 1;           ///< lanes that share a vertex
  std::uint32_t triangles_ = 0, pieces_ = 0, groups_ = 0, moving_points_ = 0, capacity_ = 0, most_points_ = 1;
  double most_margin_m_ = 0;
  int stage_pairs_ = -1, stage_ = -1;
  const vulkan::Buffer* faults_ = nullptr;
  const FrameKernel *moved_ = nullptr, *reach_ = nullptr, *count_ = nullptr, *scan_ = nullptr, *fill_ = nullptr,
                    *predict_ = nullptr, *near_ = nullptr, *query_ = nullptr, *gather_ = nullptr, *settle_ = nullptr,
                    *respond_ = nullptr, *choose_ = nullptr, *project_ = nullptr;
};

}  // namespace clothbench::pbd_gpu

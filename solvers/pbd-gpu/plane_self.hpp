#pragma once
#include "frame_builder.hpp"

namespace clothbench::pbd_gpu {

/// The cloth's pairs with itself in contact by planes (PLANES.md): triangles without a common vertex. PlaneContact has
/// the phases of vertices, and calls these between them.
class PlaneSelf {
 public:
  /// Adds buffers. `particle`: of each vertex, the vertex that it is welded to; empty: itself.
  PlaneSelf(FrameBuilder& frame, const Scene& scene, const std::vector<std::uint32_t>& particle);
  void add_list_kernels(int stage, PlaneContactSpecialization);
  void add_kernels(int stage, const std::vector<std::uint32_t>& constants);

  /// Specialization constants of all kernels of contact by planes.
  void specialize(PlaneContactSpecialization& s) const {
    s.SELF = 1;
    s.SELF_CAPACITY = capacity_;
    s.NEAR_CAPACITY = near_capacity_;
    s.TOUCHING_CAPACITY = touching_capacity_;
    s.THICKNESS_BITS = thickness_bits_;
    s.SELF_FRICTION_BITS = friction_bits_;
  }

  void record_list(const PlaneContactConstants&);
  /// Nearest points and a round of responses, before the lines (turn 0) and after them (turn 1).
  void record_query(const PlaneContactConstants&);
  void record_response(const PlaneContactConstants&);
  void record_planes(const PlaneContactConstants&);

 private:
  const FrameKernel* add(int stage, const char* name, const std::vector<std::uint32_t>& constants,
                         std::uint32_t threads = kGroupSize);
  void near_pairs(const FrameKernel* kernel, const PlaneContactConstants&);

  FrameBuilder& frame_;
  std::uint32_t triangles_ = 0, capacity_ = 0, near_capacity_ = 0, touching_capacity_ = 0, thickness_bits_ = 0,
                friction_bits_ = 0;
  std::uint32_t sharers_ = 1;  ///< threads that share a triangle's list: a subgroup
  const vulkan::Buffer* ranges_ = nullptr;
  const FrameKernel *boxes_ = nullptr, *count_ = nullptr, *scan_ = nullptr, *fill_ = nullptr, *ways_ = nullptr,
                    *near_ = nullptr, *query_ = nullptr, *respond_ = nullptr, *choose_ = nullptr;
};

}  // namespace clothbench::pbd_gpu

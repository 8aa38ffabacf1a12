#pragma once
#include <cstdint>
#include <vector>

#include "colliders.hpp"

namespace clothbench::pbd_gpu {

/// Collisions of `paper` as published: every particle against every sphere, box, capsule and triangle, on predicted
/// positions, at the end of each step. Kim, Ma & Hong 2025, 3.2.3 to 3.2.6, Algorithms 3 and 4.
class PaperContact {
 public:
  /// Adds one stage and kernel for each kind of collider in the scene. `mesh_depth_m` and `hand_depth_m`: greatest
  /// distance behind a triangle at which a particle still counts as touching it.
  PaperContact(FrameBuilder& frame, const ColliderBuffers& colliders, float mesh_depth_m, float hand_depth_m);
  /// Records the collisions of so many particles.
  void record(std::uint32_t particles);

 private:
  struct Pass {
    const FrameKernel* kernel;
    PaperContactConstants constants;
    std::uint32_t item_bytes;  ///< read by a particle for each shape or triangle it is tested against
    bool friction;
  };
  void add_shapes(const char* stage, const ShapeBuffer&, Feature, const char* kernel, std::uint32_t item_bytes);
  void add_meshes(const char* stage, const MeshBuffers&, Feature, float depth_m);

  FrameBuilder& frame_;
  std::vector<Pass> passes_;
};

}  // namespace clothbench::pbd_gpu

#pragma once
#include "frame_builder.hpp"

namespace clothbench::pbd_gpu {

/// Contact of the cloth of `xpbd` with itself. It works on positions, velocities and the positions at the substep's
/// start, independently of constraints and colliders. It runs after both, and afterwards no two pieces of the cloth
/// have crossed. README, "Self-collision in xpbd", has the method.
class XpbdSelfContact {
 public:
  /// Adds the stages KeepStart and SelfContact, their buffers and kernels. `positions` (.w = inverse mass) and
  /// velocities hold one vec4 a vertex. Throws Error for what it does not support: triangle meshes, batches.
  XpbdSelfContact(FrameBuilder& frame, const Scene& scene, const vulkan::Buffer& positions);

  /// Call at the start of a frame, before any vertex moves.
  void record_frame();
  /// Call at the end of a substep of `h` seconds.
  void record_substep(double h);

 private:
  SelfConstants constants(double h) const;
  void record_search(const SelfConstants&);
  void record_round(const SelfConstants&);

  FrameBuilder& frame_;
  const Scene& scene_;
  const vulkan::Buffer& x_;
  std::uint32_t side_ = 0, block_columns_ = 0, blocks_ = 0, words_ = 0;
  int stage_start_ = -1, stage_ = -1;
  const vulkan::Buffer* starts_ = nullptr;
  const FrameKernel *find_blocks_ = nullptr, *find_near_ = nullptr, *correct_ = nullptr, *apply_ = nullptr,
                    *certify_ = nullptr, *move_ = nullptr;
};

}  // namespace clothbench::pbd_gpu

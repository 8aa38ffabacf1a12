#pragma once
#include <vector>

#include "chain_plan.hpp"
#include "frame_builder.hpp"
#include "prediction.hpp"

namespace clothbench::pbd_gpu {

/// The constraints of `xpbd` where links are not all alike (triangle meshes, uneven grids, regions); even grids have
/// Lines. It takes one dispatch a family and substep, or one in all where the device runs all workgroups at once. One
/// iteration a substep, no bending.
class Chains {
 public:
  /// Adds its stages, buffers and kernels. The buffers of the state must exist.
  Chains(FrameBuilder& frame, const Scene& scene, const ChainCloth& cloth, bool predicts, bool tension);

  /// Records `count` substeps, each a TimeStep.
  void record(int count, const TimeStep&);
  /// Puts welded vertices where those are that they are welded to; `record` ends with it.
  void record_welds();
  bool whole_frame() const { return persistent_ && scene_.grips.vertices.empty(); }

 private:
  struct Family {
    std::uint32_t first_entry, entries, rounds;
    double vertices, free;  ///< on its chains; the first family has all vertices
  };
  void count_vertices();
  Traffic traffic(std::size_t family) const;
  vulkan::Groups all_groups() const;

  FrameBuilder& frame_;
  const Scene& scene_;
  const std::uint32_t block_;
  const bool predicts_, tension_;
  std::uint32_t tethers_ = 0;
  std::vector<Family> families_;
  std::vector<ChainEntry> entries_;
  bool persistent_ = false;
  const FrameKernel *kernel_ = nullptr, *weld_ = nullptr;
  std::uint32_t welds_ = 0;
};

}  // namespace clothbench::pbd_gpu

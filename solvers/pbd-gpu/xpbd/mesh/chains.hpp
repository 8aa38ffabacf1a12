#pragma once
#include <vector>

#include "common/frame_builder.hpp"
#include "xpbd/mesh/edge_paths.hpp"
#include "xpbd/time/integrator.hpp"

namespace clothbench::pbd_gpu {

/// The constraints of `xpbd` where links are not all alike (triangle meshes, uneven grids, regions); even grids have
/// Lines. It takes one dispatch a colour and substep, or one in all where the device runs all workgroups at once. One
/// iteration a substep. Bending of meshes is solved before the links of a substep, all at once; so are triangles of an
/// elastic mesh, instead of its links.
class Chains {
 public:
  /// Adds its stages, buffers and kernels. The buffers of the state must exist.
  Chains(FrameBuilder& frame, const Scene& scene, const ChainCloth& cloth, bool uses_bdf2, bool tension, bool membrane);

  /// Records `count` substeps, each a TimeStep. `again`: only the colours, once more from where the vertices are.
  void record(int count, const TimeStep&, bool again = false);

  /// Puts welded vertices where those are that they are welded to; `record` ends with it.
  void record_welds();
  bool is_single_dispatch() const { return persistent_ && scene_.grips.vertices.empty(); }

 private:
  void add_colours(const ChainCloth&);
  void add_bending();
  void add_membrane();
  ChainSpecialization specialization() const;
  /// Whether bending or triangles are solved, all at once.
  bool solves_together() const { return bends_ || membrane_; }
  vulkan::Groups all_groups() const;

  FrameBuilder& frame_;
  const Scene& scene_;
  const std::uint32_t block_;
  const bool uses_bdf2_, tension_, membrane_;
  std::uint32_t tethers_ = 0;
  std::vector<ChainRange> colours_;
  std::vector<ChainEntry> entries_;
  bool persistent_ = false;
  const FrameKernel *kernel_ = nullptr, *weld_ = nullptr;
  std::uint32_t welds_ = 0;
  bool bends_ = false;
  double max_per_s2_ = 0;  ///< at least the maximum eigenvalue of bending and triangles
};

}  // namespace clothbench::pbd_gpu

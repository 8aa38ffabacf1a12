#pragma once
#include <vector>

#include "common/frame_builder.hpp"
#include "xpbd/mesh/edge_paths.hpp"
#include "xpbd/time/integrator.hpp"

namespace clothbench::pbd_gpu {

/// The constraints of `xpbd` if links are not uniform (triangle meshes, uneven grids, regions); even grids use Lines.
/// There is one dispatch per colour and substep, or a single one if the device runs all workgroups at once. A substep
/// solves each colour once. Before the colours, an iteration over all vertices solves the bending of a mesh and,
/// instead of links, the triangles of an elastic mesh.
class Chains {
 public:
  /// Adds its stages, buffers and kernels. The buffers of the state must exist.
  Chains(FrameBuilder& frame, const Scene& scene, const ChainCloth& cloth, bool uses_bdf2, bool tension, bool membrane);

  /// Records `count` substeps, each with this TimeStep. `again`: only solves the colours, from the current positions.
  void record(int count, const TimeStep&, bool again = false);

  /// Records that each welded vertex follows the vertex that it is welded to; `record` ends with this.
  void record_welds();
  bool is_single_dispatch() const { return persistent_ && scene_.grips.vertices.empty(); }

 private:
  void add_colours(const ChainCloth&);
  void add_bending();
  void add_membrane();
  ChainSpecialization specialization() const;
  /// Whether bending or triangles are solved, by iterations over all vertices.
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
  double max_per_s2_ = 0;  ///< upper bound of the eigenvalues of M^-1 K, K of bending and triangles
};

}  // namespace clothbench::pbd_gpu

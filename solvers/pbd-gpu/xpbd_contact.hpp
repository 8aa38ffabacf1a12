#pragma once
#include <vector>

#include "colliders.hpp"

namespace clothbench::pbd_gpu {

/// Triangles of a mesh in clusters of neighbours, for boxes round them: at most `kClusterSize` each, every triangle in
/// exactly one. Halves along the longest side of the centroids' box, over and over.
struct Clusters {
  static constexpr std::size_t kClusterSize = 16;
  std::vector<std::uint32_t> triangles;  ///< indices, cluster after cluster
  std::vector<std::uint32_t> sizes;      ///< one a cluster
};
Clusters cluster(const std::vector<double>& positions, const std::vector<std::array<std::uint32_t, 3>>& triangles);

/// A word a triangle, of the edges opposite its corners k: bit k is set if the edge belongs to no other triangle, bit 3
/// + k if triangles meet there at an angle.
std::vector<std::uint32_t> edge_marks(const std::vector<double>& positions,
                                      const std::vector<std::array<std::uint32_t, 3>>& triangles);

/// Points on each edge: none if no edge of the scene's cloth can pass into something between two vertices that are a
/// margin away (nothing does into planes, and into a ball only an edge long enough for its height over the chord), else
/// `wanted`, or if that is negative 1, and 3 or 7 where fingers could come through between them.
std::uint32_t samples_needed(const Scene& scene, int wanted);

/// Contact of `xpbd` with what is in the scene. It works on positions, velocities and where the vertices were at the
/// substep's start, and knows nothing of how constraints are solved: it runs last in a substep, so its corrections
/// stand. README, "Contact in xpbd", has the method.
class XpbdContact {
 public:
  /// Adds buffers, the stages BroadPhase (meshes only) and Contact, and their kernels. Positions (.w = inverse mass)
  /// and velocities hold one vec4 a vertex, relative to `origin_m`.
  XpbdContact(FrameBuilder& frame, const Scene& scene, Vec3 origin_m, const ColliderBuffers& colliders, int samples);

  /// Start of a frame, after the colliders' own record().
  void record_frame(double dt_s, int substeps);
  /// End of substep s.
  void record_substep(int s, int substeps, double dt_s);

 private:
  void add_meshes();
  void add_sides(Vec3 origin_m);
  void add_kernels();
  std::uint32_t lanes() const;
  bool meshes() const { return standing_clusters_ + moving_clusters_ > 0; }
  ContactConstants constants(double dt_s, int substeps) const;

  FrameBuilder& frame_;
  const Scene& scene_;
  const ColliderBuffers& colliders_;
  const std::uint32_t samples_;  ///< an edge
  std::uint32_t lanes_ = 1;      ///< threads of the proximity query of one point
  std::uint32_t standing_clusters_ = 0, moving_clusters_ = 0, moving_triangles_ = 0;
  int stage_broad_ = -1, stage_contact_ = -1;
  const FrameKernel *find_boxes_ = nullptr, *find_candidates_ = nullptr, *vertices_ = nullptr, *sample_ = nullptr;
};

}  // namespace clothbench::pbd_gpu

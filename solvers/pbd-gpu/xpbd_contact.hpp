#pragma once
#include <vector>

#include "colliders.hpp"

namespace clothbench::pbd_gpu {

/// Triangles of a mesh in clusters of neighbours, for bounding boxes: at most `kClusterSize` each, every triangle in
/// exactly one. The mesh is halved recursively along the longest side of the centroids' box.
struct Clusters {
  static constexpr std::size_t kClusterSize = 16;
  std::vector<std::uint32_t> triangles;  ///< indices, cluster after cluster
  std::vector<std::uint32_t> sizes;      ///< one a cluster
};
Clusters cluster(const std::vector<double>& positions, const std::vector<std::array<std::uint32_t, 3>>& triangles);

/// A word a triangle with marks of the edges opposite its corners k. Bit k is set if no other triangle has the edge,
/// bit 3 + k if triangles meet there at an angle.
std::vector<std::uint32_t> edge_marks(const std::vector<double>& positions,
                                      const std::vector<std::array<std::uint32_t, 3>>& triangles);

/// Number of contact points on each edge. 0 if no edge of the cloth can enter a collider while both its vertices are a
/// margin away: no edge enters a plane, and only an edge whose chord height exceeds the margin enters a sphere. Else
/// `wanted`; if that is negative, 1, or 3 or 7 where fingers could pass between the points.
std::uint32_t samples_needed(const Scene& scene, int wanted);

/// Contact of `xpbd` with the scene's colliders. It works on positions, velocities and the positions at the substep's
/// start, independently of how constraints are solved. It runs after the constraints, so they do not undo its
/// corrections. README, "Contact in xpbd", has the method.
class XpbdContact {
 public:
  /// Adds buffers, the stages BroadPhase (meshes only) and Contact, and their kernels. Positions (.w = inverse mass)
  /// and velocities hold one vec4 a vertex, relative to `origin_m`.
  XpbdContact(FrameBuilder& frame, const Scene& scene, Vec3 origin_m, const ColliderBuffers& colliders, int samples);

  /// Call at the start of a frame, after the colliders' record().
  void record_frame(double dt_s, int substeps);
  /// Call at the end of substep s.
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
  const std::uint32_t samples_;  ///< contact points on an edge
  std::uint32_t lanes_ = 1;      ///< threads of the proximity query of one point
  std::uint32_t standing_clusters_ = 0, moving_clusters_ = 0, moving_triangles_ = 0;
  int stage_broad_ = -1, stage_contact_ = -1;
  const FrameKernel *find_boxes_ = nullptr, *find_candidates_ = nullptr, *vertices_ = nullptr, *sample_ = nullptr;
};

}  // namespace clothbench::pbd_gpu

#pragma once
#include <array>
#include <vector>

#include "common/colliders.hpp"

namespace clothbench::pbd_gpu {

/// Triangles of a mesh in clusters of neighbours: at most `kClusterSize` each, every triangle in exactly one. The mesh
/// is halved recursively along the longest side of the centroids' box.
struct Clusters {
  static constexpr std::size_t kClusterSize = 16;
  std::vector<std::uint32_t> triangles;  ///< indices, cluster after cluster
  std::vector<std::uint32_t> sizes;      ///< one a cluster
};
Clusters cluster(const std::vector<double>& positions, const std::vector<std::array<std::uint32_t, 3>>& triangles);

/// The convex shapes of a scene's colliders except for planes: of a capsule, a segment and its radius; of a
/// sphere, a point and its radius; of a box or a static mesh, each triangle; of one that is kinematic, hulls of
/// clusters of at most Clusters::kClusterSize neighbouring triangles.
struct ConvexShapes {
  std::vector<ConvexShape> shapes;
  std::vector<ShapePoint> points;    ///< convex shape after convex shape, where they are at the scene's start [m]
  std::vector<PointSource> sources;  ///< of the points of kinematic convex shapes
  std::vector<ShapeAabb> boxes;      ///< of the convex shapes, then of groups of SHAPES_PER_GROUP of them
  std::uint32_t max_points = 1;      ///< of a convex shape
  double max_margin_m = 0;
  std::vector<double> margins_m;  ///< one per collider, as used
};
/// Positions are relative to `origin_m`.
ConvexShapes convex_shapes(const Scene& scene, Vec3 origin_m, const ColliderBuffers* colliders);

}  // namespace clothbench::pbd_gpu

#pragma once
#include <array>
#include <vector>

#include "colliders.hpp"

namespace clothbench::pbd_gpu {

/// Triangles of a mesh in clusters of neighbours: at most `kClusterSize` each, every triangle in exactly one. The mesh
/// is halved recursively along the longest side of the centroids' box.
struct Clusters {
  static constexpr std::size_t kClusterSize = 16;
  std::vector<std::uint32_t> triangles;  ///< indices, cluster after cluster
  std::vector<std::uint32_t> sizes;      ///< one a cluster
};
Clusters cluster(const std::vector<double>& positions, const std::vector<std::array<std::uint32_t, 3>>& triangles);

/// The convex pieces of a scene's colliders but for planes: of a capsule, a segment and its radius; of a sphere, a
/// point and its radius; of a box or a mesh that stands, each triangle; of one that moves,
/// hulls of clusters of at most Clusters::kClusterSize neighbouring triangles.
struct ContactPieces {
  std::vector<ContactPiece> pieces;
  std::vector<PiecePoint> points;    ///< piece after piece, where they are at the scene's start [m]
  std::vector<PointSource> sources;  ///< of the points of moving pieces
  std::vector<PieceBox> boxes;       ///< of the pieces, then of groups of PIECES_A_GROUP of them
  std::uint32_t most_points = 1;     ///< of a piece
  double most_margin_m = 0;
  std::vector<double> margins_m;  ///< one a collider, those used
};
/// Positions are relative to `origin_m`.
ContactPieces contact_pieces(const Scene& scene, Vec3 origin_m, const ColliderBuffers* colliders);

}  // namespace clothbench::pbd_gpu

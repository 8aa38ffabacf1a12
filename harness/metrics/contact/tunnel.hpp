#pragma once
#include <vector>

#include "metrics/contact/triangle_mesh.hpp"

namespace clothbench::contact {

/// Signed crossings of the straight path p -> q with a mesh at rest: those along the normals minus those against.
/// Exact (predicates.hpp): through a common edge or vertex, or ending on the surface, everything counts once.
int signed_crossings(const Point<3>& p, const Point<3>& q, const TriangleTree& mesh);

/// A mesh whose vertices move from `from` to `to` during one step.
///
/// A vertex of the cloth and the mesh both move, so the crossing happens in space-time: the path is a straight segment
/// of it, and each moving triangle sweeps a prism that is cut into three tetrahedra (staircase over the vertex order,
/// so that neighbours agree about their common wall). Cutting replaces the linear motion of a triangle's inside by a
/// piecewise linear one with the same beginning and end. The sum of signed crossings is the same for both as long as
/// the path stays clear of the moving border of an open mesh: what lies between the two surfaces is empty at the
/// beginning and at the end, so that a path which enters it leaves it again. No root is searched for, and the
/// orientation tests are exact.
class SweptMesh {
 public:
  /// `from` and `to` share their triangles; `welded` from welded_vertices(from), so that repeated vertices share walls.
  SweptMesh(const TriangleMeshView& from, const TriangleMeshView& to, std::span<const std::uint32_t> welded);

  /// Signed crossings of the path that is at p when the mesh is at `from`, and at q when it is at `to`.
  int signed_crossings(const Point<3>& p, const Point<3>& q) const;

 private:
  struct Prism {
    Simplex<3> from, to;  ///< corners in vertex order
    int orientation;      ///< -1 if that order turned the normal round
  };
  std::vector<Prism> prisms_;
  BoxTree tree_;
};

/// Signed crossing count of every vertex since the start: 0 where it is on the side it started from, whether it never
/// crossed, came back the way it went, or went round the border; else it tunnelled.
class TunnelHistory {
 public:
  explicit TunnelHistory(std::size_t vertices) : counts_(vertices, 0) {}

  /// One step; both position arrays xyz interleaved and finite.
  void advance(std::span<const double> from, std::span<const double> to, const TriangleTree& mesh);
  void advance(std::span<const double> from, std::span<const double> to, const SweptMesh& mesh);

  std::span<const int> counts() const { return counts_; }
  /// Share of the total weight (rest area) of the vertices whose count isn't 0.
  double fraction(std::span<const double> weights) const;

 private:
  std::vector<int> counts_;
};

}  // namespace clothbench::contact

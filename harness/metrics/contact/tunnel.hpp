#pragma once
#include <functional>
#include <vector>

#include "metrics/contact/triangle_mesh.hpp"

namespace clothbench::contact {

/// Signed crossings of the straight path p -> q with a static mesh: the number along the normals minus the number
/// against. Exact (predicates.hpp): a path through a common edge or vertex, or one that ends on the surface, is counted
/// once.
int signed_crossings(const Point<3>& p, const Point<3>& q, const TriangleTree& mesh);

/// A mesh whose vertices move from `from` to `to` during one step.
///
/// A vertex of the cloth and the mesh both move, so the crossing happens in space-time. There the path is a straight
/// segment, and each moving triangle sweeps a prism that is cut into three tetrahedra (staircase over the vertex order,
/// so that neighbours agree about their common wall). Cutting replaces the linear motion inside a triangle by a
/// piecewise linear one with the same beginning and end. Both have the same sum of signed crossings as long as the path
/// does not cross the moving border of an open mesh: the volume between the two surfaces is empty at the beginning and
/// at the end, so a path that enters it also leaves it. No root is searched for, and the orientation tests are exact.
class SweptMesh {
 public:
  /// `from` and `to` share their triangles; `welded` from welded_vertices(from), so that repeated vertices share walls.
  SweptMesh(const TriangleMeshView& from, const TriangleMeshView& to, std::span<const std::uint32_t> welded);

  /// Signed crossings of the path from p, when the mesh is at `from`, to q, when it is at `to`.
  int signed_crossings(const Point<3>& p, const Point<3>& q) const;

 private:
  struct Prism {
    Simplex<3> from, to;  ///< corners in vertex order
    int orientation;      ///< -1 if that order reverses the normal
  };
  std::vector<Prism> prisms_;
  BoxTree tree_;
};

/// The edges at which a mesh is open.
class Border {
 public:
  /// `welded` from welded_vertices(mesh). Copies what it needs.
  Border(const TriangleMeshView& mesh, std::span<const std::uint32_t> welded);

  /// Whether a point cannot have moved around the border in a step from p to q: the sum of its distances to the border
  /// before and after exceeds twice its displacement. `from`, `to`: the mesh's positions; the maximum displacement of
  /// the mesh is added to the point's.
  bool out_of_reach(const Point<3>& p, const Point<3>& q, std::span<const double> from,
                    std::span<const double> to) const;

 private:
  std::vector<Link> edges_;
};

/// Evidence that the crossings of a step took place. Evaluated only if the result depends on it.
struct StepEvidence {
  std::function<bool()> contour;  ///< whether cloth and mesh intersect at the step's start or end
  /// Whether a point cannot have moved around the border.
  std::function<bool(const Point<3>&, const Point<3>&)> out_of_reach;
};

/// Signed crossing count of every vertex since the start. It is 0 for a vertex on its initial side: one that never
/// crossed, crossed back, or moved around the border. Any other count means that the vertex has tunnelled.
///
/// The straight path between two frames may cut a border that the vertex moved around. Without a contour, no link of
/// the cloth crosses the mesh, and a link between a vertex that crossed and one that did not leads around a border. So
/// without a contour the crossings of linked vertices that crossed alike count only if they have no link to others, or
/// if the border is out of reach for one of them.
class TunnelHistory {
 public:
  /// `links` between the vertices. Without them every crossing counts.
  explicit TunnelHistory(std::size_t vertices, std::vector<Link> links = {})
      : counts_(vertices, 0), links_(std::move(links)) {}

  /// One step; both position arrays xyz interleaved and finite.
  void advance(std::span<const double> from, std::span<const double> to, const TriangleTree& mesh, const StepEvidence&);

  std::span<const int> counts() const { return counts_; }

 private:
  void drop_unproven(std::vector<int>& step, std::span<const double> from, std::span<const double> to,
                     const StepEvidence&) const;

  std::vector<int> counts_;
  std::vector<Link> links_;
};

}  // namespace clothbench::contact

#pragma once
#include <Eigen/Core>
#include <Eigen/Geometry>
#include <array>
#include <cstdint>
#include <optional>
#include <span>
#include <unsupported/Eigen/BVH>
#include <vector>

#include "clothbench/collider.hpp"

namespace clothbench::contact {

template <int N>
using Point = Eigen::Matrix<double, N, 1>;

/// N points in N dimensions: a triangle for N = 3, a tetrahedron in space-time (x, y, z, t) for N = 4.
template <int N>
using Simplex = std::array<Point<N>, N>;

/// Exact sign (-1, 0, 1) of det(head[0] - tail[0], ..., head[N-1] - tail[N-1]), with exact differences. N = 2, 3, 4.
/// Uses floating point with an error bound first (after Shewchuk 1997), then exact arithmetic if the sign is uncertain.
template <int N>
int sign_of_determinant(const std::array<Point<N>, N>& head, const std::array<Point<N>, N>& tail);

/// Direction in which the segment p -> q crosses the simplex: +1 along its normal, -1 against it, 0 if it does not.
///
/// Exact, also in degenerate configurations of p, q and the simplex: there the segment is translated by shift * (e,
/// e^2, e^3) in space, e -> 0+ (simulation of simplicity, Edelsbrunner & Muecke 1990, with one common translation). One
/// translation for all tests is consistent: a path through an edge or vertex shared by triangles crosses the ones that
/// it crosses after a small translation, and a path that ends on a surface ends on a definite side. A simplex without
/// volume is never crossed. A triangle (a, b, c) has the normal (b - a) x (c - a).
template <int N>
int crossing(const Point<N>& p, const Point<N>& q, const Simplex<N>& simplex, int shift = 1);

/// Whether the area is exactly zero.
bool is_degenerate(const Simplex<3>& triangle);

inline Point<3> point(const Vec3& v) { return {v[0], v[1], v[2]}; }
/// Point `i` of coordinates, xyz interleaved.
inline Point<3> point_at(std::span<const double> x, std::size_t i) { return Point<3>::Map(x.data() + 3 * i); }

/// Plain arrays: positions [m], xyz interleaved; triangles, 3 vertex indices each, counter-clockwise seen from the
/// side to which the normal points. Triangles may be degenerate, and vertices may be repeated instead of shared.
struct TriangleMeshView {
  std::span<const double> positions;
  std::span<const std::array<std::uint32_t, 3>> triangles;

  std::size_t vertex_count() const { return positions.size() / 3; }
  Point<3> vertex(std::size_t i) const { return point_at(positions, i); }
  Simplex<3> triangle(std::size_t t) const;
};

bool all_finite(std::span<const double>);

/// For every vertex, the lowest index of a vertex at exactly the same position.
std::vector<std::uint32_t> welded_vertices(const TriangleMeshView&);

/// Indices of two neighbouring vertices of a cloth.
using Link = std::array<std::uint32_t, 2>;

/// The edges of triangles, each once, with the lower vertex first; in ascending order.
std::vector<Link> edges_of(std::span<const std::array<std::uint32_t, 3>> triangles);

double area(const Simplex<3>& triangle);

using Box = Eigen::AlignedBox3d;

inline Box box_of(const Simplex<3>& t) { return Box(t[0]).extend(t[1]).extend(t[2]); }
/// The box with all its faces moved outwards [m].
inline Box grown(const Box& b, double by) {
  return {b.min() - Point<3>::Constant(by), b.max() + Point<3>::Constant(by)};
}

/// A bounding volume hierarchy over the boxes of items 0..n-1.
class BoxTree {
 public:
  BoxTree() = default;
  explicit BoxTree(std::vector<Box> boxes);

  /// visit(item) for every item whose box overlaps or touches `query`.
  template <class Visit>
  void for_each_overlapping(const Box& query, Visit visit) const {
    if (boxes_.empty() || !query.intersects(box_)) return;
    std::vector<int> stack{hierarchy_.getRootIndex()};
    while (!stack.empty()) {
      const int node = stack.back();
      stack.pop_back();
      Hierarchy::VolumeIterator volume = nullptr, volume_end = nullptr;
      Hierarchy::ObjectIterator item = nullptr, item_end = nullptr;
      hierarchy_.getChildren(node, volume, volume_end, item, item_end);
      for (; volume != volume_end; ++volume)
        if (query.intersects(hierarchy_.getVolume(*volume))) stack.push_back(*volume);
      for (; item != item_end; ++item)
        if (query.intersects(boxes_[*item])) visit(*item);
    }
  }

  /// The item with the smallest squared_distance(item) below `bound`; -1 if none. `bound` becomes its squared distance.
  /// squared_distance must be at least the squared distance from `p` to the item's box.
  template <class SquaredDistance>
  int nearest(const Point<3>& p, double& bound, SquaredDistance squared_distance) const {
    int best = -1;
    if (boxes_.empty()) return best;
    struct Entry {
      int node;
      double squared;
    };
    std::vector<Entry> stack{{hierarchy_.getRootIndex(), 0}};
    while (!stack.empty()) {
      const Entry entry = stack.back();
      stack.pop_back();
      if (!(entry.squared < bound)) continue;
      Hierarchy::VolumeIterator volume = nullptr, volume_end = nullptr;
      Hierarchy::ObjectIterator item = nullptr, item_end = nullptr;
      hierarchy_.getChildren(entry.node, volume, volume_end, item, item_end);
      for (; item != item_end; ++item) {
        if (!(boxes_[*item].squaredExteriorDistance(p) < bound)) continue;
        const double squared = squared_distance(*item);
        if (squared < bound) {
          bound = squared;
          best = *item;
        }
      }
      const std::size_t first = stack.size();
      for (; volume != volume_end; ++volume) {
        const double squared = hierarchy_.getVolume(*volume).squaredExteriorDistance(p);
        if (squared < bound) stack.push_back({*volume, squared});
      }
      // The nearer child is pushed last, so that it is visited first.
      if (stack.size() == first + 2 && stack[first].squared < stack[first + 1].squared)
        std::swap(stack[first], stack[first + 1]);
    }
    return best;
  }

  const Box& box() const { return box_; }
  const std::vector<Box>& item_boxes() const { return boxes_; }

 private:
  using Hierarchy = Eigen::KdBVH<double, 3, int>;
  std::vector<Box> boxes_;
  Box box_;
  Hierarchy hierarchy_;
};

/// The triangles of a mesh that have a positive area, in a tree for queries. Copies its input.
class TriangleTree {
 public:
  /// Throws Error unless positions come in threes, indices are in range and numbers are finite.
  explicit TriangleTree(const TriangleMeshView&);

  const std::vector<Simplex<3>>& triangles() const { return triangles_; }
  /// Indices of these triangles in the mesh.
  const std::vector<std::uint32_t>& numbers() const { return numbers_; }
  const BoxTree& tree() const { return tree_; }

  /// Distance [m] from p to the nearest triangle; infinite if there is none.
  double distance(const Point<3>& p) const;

 private:
  std::vector<Simplex<3>> triangles_;
  std::vector<std::uint32_t> numbers_;
  BoxTree tree_;
};

/// Squared distance from a point to a triangle; accurate for slivers too.
double squared_distance(const Point<3>& p, const Simplex<3>& triangle);

/// All points within `radius_m` of the segment a-b; a sphere if a = b.
struct Capsule {
  Point<3> a, b;
  double radius_m;
};

/// Parameter of the axis point nearest to p, from 0 at a to 1 at b; 0 for a sphere.
double axis_share(const Point<3>& p, const Capsule&);

/// Signed distance [m] to the surface, negative inside; exact.
double signed_distance(const Point<3>& p, const Capsule&);

/// Triangles that have their corners on the surface of a capsule, counter-clockwise seen from outside.
struct CapsuleMesh {
  std::vector<double> positions;
  std::vector<std::array<std::uint32_t, 3>> triangles;
  TriangleMeshView view() const { return {positions, triangles}; }
};

/// The triangles lie inside the capsule, so cloth outside the capsule never crosses them. With kCapsuleSides sides
/// around the axis and a quarter as many from equator to pole, they are at most 1 - cos²(π / kCapsuleSides) of the
/// radius below the surface; kCapsuleError is that number rounded up.
CapsuleMesh capsule_mesh(const Capsule&);
inline constexpr int kCapsuleSides = 32;
inline constexpr double kCapsuleError = 0.01;

/// The surface near a point.
struct Nearest {
  double distance_m;   ///< signed for capsules, unsigned for triangles
  Point<3> normal;     ///< unit vector from the surface to the point; zero if the point is on the surface or on an axis
  Point<3> carried_m;  ///< displacement of that surface point since the previous frame
};

/// Nearest point of a union of capsules. `before`: the capsules one frame earlier; assumes no spin about their axes.
Nearest nearest(const Point<3>& p, std::span<const Capsule> now, std::span<const Capsule> before);

/// The nearest point of a mesh within `bound_m`, if any. `before`: the mesh at the previous frame; null: it is static.
std::optional<Nearest> nearest(const Point<3>& p, const TriangleTree& mesh, double bound_m,
                               const TriangleMeshView* before = nullptr);

/// Whether a triangle has a point at most `reach_m` from a mesh.
bool within(const Simplex<3>& triangle, const TriangleTree& mesh, double reach_m);

/// Corner weights, 0 to 1, of the point of a triangle nearest to p (Ericson, Real-Time Collision Detection, 5.1.5).
Point<3> nearest_weights(const Point<3>& p, const Simplex<3>& triangle);

/// Squared distance [m2] between the segments a-b and c-d (Ericson, Real-Time Collision Detection, 5.1.9).
double squared_distance(const Point<3>& a, const Point<3>& b, const Point<3>& c, const Point<3>& d);

/// Squared distance [m2] between the segment a-b and a triangle: 0 if they cross.
double squared_distance(const Point<3>& a, const Point<3>& b, const Simplex<3>& triangle);

/// Whether a triangle has a point at most `reach_m` from the surface of a capsule, or inside the capsule.
bool within(const Simplex<3>& triangle, const Capsule&, double reach_m);

/// Whether two triangles have points at most `reach_m` apart.
bool within(const Simplex<3>& triangle, const Simplex<3>& other, double reach_m);

}  // namespace clothbench::contact

#pragma once
#include <Eigen/Geometry>
#include <array>
#include <cstdint>
#include <span>
#include <unsupported/Eigen/BVH>
#include <vector>

#include "clothbench/collider.hpp"
#include "metrics/contact/predicates.hpp"

namespace clothbench::contact {

inline Point<3> point(const Vec3& v) { return {v[0], v[1], v[2]}; }

/// Plain arrays: positions [m], xyz interleaved; triangles, 3 vertex indices each, seen counter-clockwise from the
/// side the normal points to. Triangles may be degenerate, and vertices may be repeated instead of shared.
struct TriangleMeshView {
  std::span<const double> positions;
  std::span<const std::array<std::uint32_t, 3>> triangles;

  std::size_t vertex_count() const { return positions.size() / 3; }
  Point<3> vertex(std::size_t i) const { return Point<3>::Map(positions.data() + 3 * i); }
  Simplex<3> triangle(std::size_t t) const;
};

/// Throws Error, naming `what`, unless positions come in threes, indices are in range and numbers are finite.
void validate(const TriangleMeshView&, const char* what);

bool all_finite(std::span<const double>);

/// For every vertex, the lowest index of a vertex at exactly the same position.
std::vector<std::uint32_t> welded_vertices(const TriangleMeshView&);

/// Two neighbouring points of a cloth, by number.
using Link = std::array<std::uint32_t, 2>;

/// The edges of triangles, each once, the lower vertex first, in order.
std::vector<Link> edges_of(std::span<const std::array<std::uint32_t, 3>> triangles);

double area(const Simplex<3>& triangle);

using Box = Eigen::AlignedBox3d;

inline Box box_of(const Simplex<3>& t) { return Box(t[0]).extend(t[1]).extend(t[2]); }
/// The box with all its faces moved outwards [m].
inline Box grown(const Box& b, double by) {
  return {b.min() - Point<3>::Constant(by), b.max() + Point<3>::Constant(by)};
}

/// A hierarchy of boxes over items 0..n-1.
class BoxTree {
 public:
  BoxTree() = default;
  explicit BoxTree(std::vector<Box> boxes);

  /// visit(item) for every item whose box meets `query`, faces included.
  template <class Visit>
  void for_each_overlapping(const Box& query, Visit visit) const;

  /// The item with the smallest squared_distance(item) below `bound`; -1 if there is none. `bound` becomes that
  /// distance. squared_distance must not be less than the squared distance from `p` to the item's box.
  template <class SquaredDistance>
  int nearest(const Point<3>& p, double& bound, SquaredDistance squared_distance) const;

  const Box& box() const { return box_; }
  const std::vector<Box>& item_boxes() const { return boxes_; }
  using Hierarchy = Eigen::KdBVH<double, 3, int>;

 private:
  std::vector<Box> boxes_;
  Box box_;
  Hierarchy hierarchy_;
};

/// The triangles of a mesh that have area, in a tree for queries. Copies the data it needs.
class TriangleTree {
 public:
  /// Throws Error for a mesh that `validate` rejects.
  explicit TriangleTree(const TriangleMeshView&);

  const std::vector<Simplex<3>>& triangles() const { return triangles_; }
  /// Their numbers in the mesh.
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

template <class Visit>
void BoxTree::for_each_overlapping(const Box& query, Visit visit) const {
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

template <class SquaredDistance>
int BoxTree::nearest(const Point<3>& p, double& bound, SquaredDistance squared_distance) const {
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
    // The nearer child goes on top of the stack, so that it is visited first.
    if (stack.size() == first + 2 && stack[first].squared < stack[first + 1].squared)
      std::swap(stack[first], stack[first + 1]);
  }
  return best;
}

}  // namespace clothbench::contact

#include "metrics/contact/tunnel.hpp"

#include <algorithm>
#include <utility>

namespace clothbench::contact {
namespace {

Point<4> at_time(const Point<3>& p, double t) { return {p[0], p[1], p[2], t}; }

template <class Count>
void advance_all(std::span<const double> from, std::span<const double> to, std::vector<int>& counts, Count count) {
  for (std::size_t i = 0; i < counts.size(); ++i)
    counts[i] += count(Point<3>(Point<3>::Map(from.data() + 3 * i)), Point<3>(Point<3>::Map(to.data() + 3 * i)));
}

}  // namespace

int signed_crossings(const Point<3>& p, const Point<3>& q, const TriangleTree& mesh) {
  if (p == q) return 0;
  int sum = 0;
  mesh.tree().for_each_overlapping(Box(p).extend(q), [&](int t) { sum += crossing<3>(p, q, mesh.triangles()[t]); });
  return sum;
}

SweptMesh::SweptMesh(const TriangleMeshView& from, const TriangleMeshView& to, std::span<const std::uint32_t> welded) {
  std::vector<Box> boxes;
  for (const auto& triangle : from.triangles) {
    std::array<std::uint32_t, 3> corner = triangle;
    Prism prism{{}, {}, 1};
    const auto order = [&](int a, int b) {
      if (welded[corner[a]] <= welded[corner[b]]) return;
      std::swap(corner[a], corner[b]);
      prism.orientation = -prism.orientation;
    };
    order(0, 1);
    order(1, 2);
    order(0, 1);
    Box box;
    for (int i = 0; i < 3; ++i) {
      prism.from[i] = from.vertex(corner[i]);
      prism.to[i] = to.vertex(corner[i]);
      box.extend(prism.from[i]).extend(prism.to[i]);
    }
    prisms_.push_back(prism);
    boxes.push_back(box);
  }
  tree_ = BoxTree(std::move(boxes));
}

int SweptMesh::signed_crossings(const Point<3>& p, const Point<3>& q) const {
  int sum = 0;
  const Point<4> start = at_time(p, 0), end = at_time(q, 1);
  tree_.for_each_overlapping(Box(p).extend(q), [&](int item) {
    const Prism& prism = prisms_[item];
    std::array<Point<4>, 3> v, w;
    for (int i = 0; i < 3; ++i) {
      v[i] = at_time(prism.from[i], 0);
      w[i] = at_time(prism.to[i], 1);
    }
    // For a static triangle det(v1 - v0, v2 - v0, w2 - v0, x - v0) = -n.(x - v0), and + - for the other two.
    sum -= prism.orientation * crossing<4>(start, end, {v[0], v[1], v[2], w[2]});
    sum += prism.orientation * crossing<4>(start, end, {v[0], v[1], w[1], w[2]});
    sum -= prism.orientation * crossing<4>(start, end, {v[0], w[0], w[1], w[2]});
  });
  return sum;
}

void TunnelHistory::advance(std::span<const double> from, std::span<const double> to, const TriangleTree& mesh) {
  advance_all(from, to, counts_,
              [&](const Point<3>& p, const Point<3>& q) { return contact::signed_crossings(p, q, mesh); });
}

void TunnelHistory::advance(std::span<const double> from, std::span<const double> to, const SweptMesh& mesh) {
  advance_all(from, to, counts_, [&](const Point<3>& p, const Point<3>& q) { return mesh.signed_crossings(p, q); });
}

double TunnelHistory::fraction(std::span<const double> weights) const {
  double through = 0, all = 0;
  for (std::size_t i = 0; i < counts_.size(); ++i) {
    all += weights[i];
    if (counts_[i] != 0) through += weights[i];
  }
  return through / all;
}

}  // namespace clothbench::contact

#include "metrics/contact/tunnel.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <utility>

#include "metrics/contact/surface.hpp"

namespace clothbench::contact {
namespace {

Point<4> at_time(const Point<3>& p, double t) { return {p[0], p[1], p[2], t}; }

Point<3> vertex_of(std::span<const double> x, std::size_t i) { return Point<3>::Map(x.data() + 3 * i); }

/// Whether a coordinate separates the motion p -> q from the triangle that moves from `from` to `to`. Both motions are
/// linear, so a strict separation at the start and at the end holds in between, and a translation by e changes nothing.
bool separated_by_coordinate(const Point<3>& p, const Point<3>& q, const Simplex<3>& from, const Simplex<3>& to) {
  for (int k = 0; k < 3; ++k) {
    const auto [low_from, high_from] = std::minmax({from[0][k], from[1][k], from[2][k]});
    const auto [low_to, high_to] = std::minmax({to[0][k], to[1][k], to[2][k]});
    if ((p[k] < low_from && q[k] < low_to) || (p[k] > high_from && q[k] > high_to)) return true;
  }
  return false;
}

}  // namespace

int signed_crossings(const Point<3>& p, const Point<3>& q, const TriangleTree& mesh) {
  if (p == q) return 0;
  int sum = 0;
  mesh.tree().for_each_overlapping(Box(p).extend(q), [&](int t) { sum += crossing<3>(p, q, mesh.triangles()[t]); });
  return sum;
}

/// The ray follows the axis that leaves the mesh's box soonest, so the ray's box is the ray itself.
bool is_inside(const Point<3>& p, const TriangleTree& mesh) {
  const Box& box = mesh.tree().box();
  if (mesh.triangles().empty() || !box.contains(p)) return false;
  int axis = 0;
  bool up = true;
  double least = box.max()[0] - p[0];
  for (int k = 0; k < 3; ++k) {
    if (box.max()[k] - p[k] < least) axis = k, up = true, least = box.max()[k] - p[k];
    if (p[k] - box.min()[k] < least) axis = k, up = false, least = p[k] - box.min()[k];
  }
  Point<3> outside = p;
  outside[axis] = up ? box.max()[axis] + box.diagonal().norm() : box.min()[axis] - box.diagonal().norm();
  return signed_crossings(p, outside, mesh) > 0;
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
    if (separated_by_coordinate(p, q, prism.from, prism.to)) return;
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

namespace {

/// The edges at which a mesh is open.
std::vector<Link> border_of(const TriangleMeshView& mesh) {
  const std::vector<std::uint32_t> welded = welded_vertices(mesh);
  std::map<Link, int> passes;
  for (const auto& corner : mesh.triangles)
    for (int i = 0; i < 3; ++i) {
      const std::uint32_t a = welded[corner[i]], b = welded[corner[(i + 1) % 3]];
      if (a != b) passes[{std::min(a, b), std::max(a, b)}] += a < b ? 1 : -1;
    }
  std::vector<Link> out;
  for (const auto& [edge, sum] : passes)
    if (sum != 0) out.push_back(edge);
  return out;
}

bool crosses(const Point<3>& p, const Point<3>& q, const TriangleTree& mesh) {
  bool any = false;
  mesh.tree().for_each_overlapping(
      Box(p).extend(q), [&](int t) { any = any || (p != q && crossing<3>(p, q, mesh.triangles()[t]) != 0); });
  return any;
}

}  // namespace

std::vector<int> proven_crossings(std::span<const double> from, std::span<const double> to,
                                  const TriangleMeshView& mesh, const TriangleTree& tree, std::span<const Link> links) {
  std::vector<int> step(from.size() / 3);
  for (std::size_t i = 0; i < step.size(); ++i) step[i] = signed_crossings(vertex_of(from, i), vertex_of(to, i), tree);
  const auto differ = [&](const Link& l) { return step[l[0]] != step[l[1]]; };
  const auto crosses_at = [&](std::span<const double> x) {
    return std::any_of(links.begin(), links.end(),
                       [&](const Link& l) { return crosses(vertex_of(x, l[0]), vertex_of(x, l[1]), tree); });
  };
  if (std::none_of(links.begin(), links.end(), differ) || crosses_at(from) || crosses_at(to)) return step;

  // A vertex cannot have moved around the border if the sum of its distances to it before and after exceeds twice its
  // displacement.
  const std::vector<Link> border = border_of(mesh);
  const auto distance = [&](const Point<3>& point) {
    double least = std::numeric_limits<double>::infinity();
    for (const auto& [a, b] : border)
      least = std::min(least, squared_distance(point, point, mesh.vertex(a), mesh.vertex(b)));
    return std::sqrt(least);
  };
  std::vector<bool> proven(step.size(), false);
  for (std::size_t i = 0; i < step.size(); ++i) {
    const Point<3> p = vertex_of(from, i), q = vertex_of(to, i);
    proven[i] = step[i] != 0 && distance(p) + distance(q) > 2 * (q - p).norm();
  }
  for (bool changed = true; changed;) {
    changed = false;
    for (const auto& [a, b] : links)
      if (step[a] == step[b] && step[a] != 0 && proven[a] != proven[b]) proven[a] = proven[b] = changed = true;
  }
  // From the border of a piece inwards.
  for (bool changed = true; changed;) {
    changed = false;
    for (const auto& [a, b] : links) {
      if (step[a] == step[b]) continue;
      for (const std::uint32_t i : {a, b})
        if (!proven[i] && step[i] != 0) step[i] = 0, changed = true;
    }
  }
  return step;
}

}  // namespace clothbench::contact

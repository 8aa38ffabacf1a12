#include "metrics/contact/triangle_mesh.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>
#include <string>
#include <utility>

#include "clothbench/error.hpp"

namespace clothbench::contact {
namespace {

double squared_distance_to_segment(const Point<3>& p, const Point<3>& a, const Point<3>& b) {
  const Point<3> ab = b - a;
  const double t = ab.dot(p - a) / ab.squaredNorm();
  return (p - (t > 0 ? a + std::min(t, 1.0) * ab : a)).squaredNorm();
}

}  // namespace

Simplex<3> TriangleMeshView::triangle(std::size_t t) const {
  const auto& corner = triangles[t];
  return {vertex(corner[0]), vertex(corner[1]), vertex(corner[2])};
}

bool all_finite(std::span<const double> numbers) {
  return std::all_of(numbers.begin(), numbers.end(), [](double x) { return std::isfinite(x); });
}

void validate(const TriangleMeshView& mesh, const char* what) {
  const std::string name = what;
  if (mesh.positions.size() % 3 != 0)
    throw Error(name + ": expected 3 numbers per vertex, got " + std::to_string(mesh.positions.size()) + " in all");
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t)
    for (const std::uint32_t v : mesh.triangles[t])
      if (v >= mesh.vertex_count())
        throw Error(name + ": triangle " + std::to_string(t) + " names vertex " + std::to_string(v) +
                    ", expected less than " + std::to_string(mesh.vertex_count()));
  for (std::size_t i = 0; i < mesh.positions.size(); ++i)
    if (!std::isfinite(mesh.positions[i])) throw Error(name + ": vertex " + std::to_string(i / 3) + " is not finite");
}

std::vector<std::uint32_t> welded_vertices(const TriangleMeshView& mesh) {
  std::vector<std::uint32_t> order(mesh.vertex_count());
  std::iota(order.begin(), order.end(), 0u);
  const double* x = mesh.positions.data();
  const auto place = [x](std::uint32_t v) { return std::array{x[3 * v], x[3 * v + 1], x[3 * v + 2]}; };
  std::sort(order.begin(), order.end(),
            [&](std::uint32_t a, std::uint32_t b) { return std::pair(place(a), a) < std::pair(place(b), b); });
  std::vector<std::uint32_t> welded(order.size());
  for (std::size_t i = 0; i < order.size(); ++i)
    welded[order[i]] = i > 0 && place(order[i]) == place(order[i - 1]) ? welded[order[i - 1]] : order[i];
  return welded;
}

std::vector<Link> edges_of(std::span<const std::array<std::uint32_t, 3>> triangles) {
  std::vector<Link> edges;
  for (const auto& corner : triangles)
    for (int i = 0; i < 3; ++i) {
      const std::uint32_t a = corner[i], b = corner[(i + 1) % 3];
      edges.push_back({std::min(a, b), std::max(a, b)});
    }
  std::sort(edges.begin(), edges.end());
  edges.erase(std::unique(edges.begin(), edges.end()), edges.end());
  return edges;
}

double area(const Simplex<3>& v) { return 0.5 * (v[1] - v[0]).cross(v[2] - v[0]).norm(); }

BoxTree::BoxTree(std::vector<Box> boxes) : boxes_(std::move(boxes)) {
  std::vector<int> items(boxes_.size());
  std::iota(items.begin(), items.end(), 0);
  hierarchy_.init(items.begin(), items.end(), boxes_.begin(), boxes_.end());
  for (const Box& b : boxes_) box_.extend(b);
}

TriangleTree::TriangleTree(const TriangleMeshView& mesh) {
  validate(mesh, "contact object");
  std::vector<Box> boxes;
  triangles_.reserve(mesh.triangles.size());
  boxes.reserve(mesh.triangles.size());
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
    const Simplex<3> triangle = mesh.triangle(t);
    if (is_degenerate(triangle)) continue;
    triangles_.push_back(triangle);
    numbers_.push_back(static_cast<std::uint32_t>(t));
    boxes.push_back(box_of(triangle));
  }
  tree_ = BoxTree(std::move(boxes));
}

double TriangleTree::distance(const Point<3>& p) const {
  double squared = std::numeric_limits<double>::infinity();
  tree_.nearest(p, squared, [&](int t) { return squared_distance(p, triangles_[t]); });
  return std::sqrt(squared);
}

double squared_distance(const Point<3>& p, const Simplex<3>& v) {
  const Point<3> normal = (v[1] - v[0]).cross(v[2] - v[0]);
  bool above = true;
  for (int i = 0; i < 3; ++i) above = above && normal.cross(v[(i + 1) % 3] - v[i]).dot(p - v[i]) >= 0;
  if (above && normal.squaredNorm() > 0) {
    const double height = normal.dot(p - v[0]);
    return height * height / normal.squaredNorm();
  }
  return std::min({squared_distance_to_segment(p, v[0], v[1]), squared_distance_to_segment(p, v[1], v[2]),
                   squared_distance_to_segment(p, v[2], v[0])});
}

}  // namespace clothbench::contact

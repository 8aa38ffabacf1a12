#include "metrics/contact/triangle_mesh.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
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

Point<3> direction(const Point<3>& v) {
  const double length = v.norm();
  return length > 0 ? Point<3>(v / length) : Point<3>(Point<3>::Zero());
}

/// Throws Error unless positions come in threes, indices are in range and numbers are finite.
void validate(const TriangleMeshView& mesh) {
  const std::string name = "contact object";
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

}  // namespace

Simplex<3> TriangleMeshView::triangle(std::size_t t) const {
  const auto& corner = triangles[t];
  return {vertex(corner[0]), vertex(corner[1]), vertex(corner[2])};
}

bool all_finite(std::span<const double> numbers) {
  return std::all_of(numbers.begin(), numbers.end(), [](double x) { return std::isfinite(x); });
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
  validate(mesh);
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

double axis_share(const Point<3>& p, const Capsule& c) {
  const Point<3> axis = c.b - c.a;
  const double squared = axis.squaredNorm();
  return squared > 0 ? std::clamp(axis.dot(p - c.a) / squared, 0.0, 1.0) : 0.0;
}

double signed_distance(const Point<3>& p, const Capsule& c) {
  return (p - (c.a + axis_share(p, c) * (c.b - c.a))).norm() - c.radius_m;
}

CapsuleMesh capsule_mesh(const Capsule& c) {
  constexpr int kQuarter = kCapsuleSides / 4;
  const Point<3> along = c.a == c.b ? Point<3>(Point<3>::UnitZ()) : Point<3>((c.b - c.a).normalized());
  const Point<3> u = along.unitOrthogonal(), v = along.cross(u);
  CapsuleMesh mesh;
  const auto add = [&](const Point<3>& p) { mesh.positions.insert(mesh.positions.end(), {p[0], p[1], p[2]}); };
  int rings = 0;
  const auto ring = [&](const Point<3>& centre, int step) {  // `step` quarters from the equator, towards b if positive
    const double latitude = 0.5 * std::numbers::pi * step / kQuarter;
    for (int k = 0; k < kCapsuleSides; ++k) {
      const double t = 2 * std::numbers::pi * k / kCapsuleSides;
      add(centre +
          c.radius_m * (std::sin(latitude) * along + std::cos(latitude) * (std::cos(t) * u + std::sin(t) * v)));
    }
    ++rings;
  };
  add(c.a - c.radius_m * along);
  for (int step = 1 - kQuarter; step <= 0; ++step) ring(c.a, step);
  for (int step = c.a == c.b ? 1 : 0; step < kQuarter; ++step) ring(c.b, step);
  add(c.b + c.radius_m * along);
  const auto last = static_cast<std::uint32_t>(1 + rings * kCapsuleSides);
  const auto at = [&](int r, int k) { return static_cast<std::uint32_t>(1 + r * kCapsuleSides + k % kCapsuleSides); };
  for (int k = 0; k < kCapsuleSides; ++k) {
    mesh.triangles.push_back({0, at(0, k + 1), at(0, k)});
    mesh.triangles.push_back({last, at(rings - 1, k), at(rings - 1, k + 1)});
    for (int r = 0; r + 1 < rings; ++r) {
      mesh.triangles.push_back({at(r, k), at(r, k + 1), at(r + 1, k + 1)});
      mesh.triangles.push_back({at(r, k), at(r + 1, k + 1), at(r + 1, k)});
    }
  }
  return mesh;
}

Nearest nearest(const Point<3>& p, std::span<const Capsule> now, std::span<const Capsule> before) {
  Nearest best{std::numeric_limits<double>::infinity(), Point<3>::Zero(), Point<3>::Zero()};
  for (std::size_t k = 0; k < now.size(); ++k) {
    const double t = axis_share(p, now[k]);
    const Point<3> axis = now[k].a + t * (now[k].b - now[k].a);
    const double distance = (p - axis).norm() - now[k].radius_m;
    if (!(distance < best.distance_m)) continue;
    best = {distance, direction(p - axis), axis - (before[k].a + t * (before[k].b - before[k].a))};
  }
  return best;
}

Point<3> nearest_weights(const Point<3>& p, const Simplex<3>& triangle) {
  const auto& [a, b, c] = triangle;
  const Point<3> ab = b - a, ac = c - a, ap = p - a, bp = p - b, cp = p - c;
  const double d1 = ab.dot(ap), d2 = ac.dot(ap), d3 = ab.dot(bp), d4 = ac.dot(bp), d5 = ab.dot(cp), d6 = ac.dot(cp);
  if (d1 <= 0 && d2 <= 0) return {1, 0, 0};
  if (d3 >= 0 && d4 <= d3) return {0, 1, 0};
  if (d6 >= 0 && d5 <= d6) return {0, 0, 1};
  const double vc = d1 * d4 - d3 * d2, vb = d5 * d2 - d1 * d6, va = d3 * d6 - d5 * d4;
  if (vc <= 0 && d1 >= 0 && d3 <= 0) {
    const double t = d1 / (d1 - d3);
    return {1 - t, t, 0};
  }
  if (vb <= 0 && d2 >= 0 && d6 <= 0) {
    const double t = d2 / (d2 - d6);
    return {1 - t, 0, t};
  }
  if (va <= 0 && d4 - d3 >= 0 && d5 - d6 >= 0) {
    const double t = (d4 - d3) / ((d4 - d3) + (d5 - d6));
    return {0, 1 - t, t};
  }
  const double all = va + vb + vc;
  return {va / all, vb / all, vc / all};
}

std::optional<Nearest> nearest(const Point<3>& p, const TriangleTree& mesh, double bound_m,
                               const TriangleMeshView* before) {
  double bound = bound_m * bound_m;
  const int found = mesh.tree().nearest(
      p, bound, [&](int t) { return squared_distance(p, mesh.triangles()[static_cast<std::size_t>(t)]); });
  if (found < 0) return std::nullopt;
  const Simplex<3>& corner = mesh.triangles()[static_cast<std::size_t>(found)];
  const Point<3> w = nearest_weights(p, corner), at = w[0] * corner[0] + w[1] * corner[1] + w[2] * corner[2];
  Nearest out{std::sqrt(bound), direction(p - at), Point<3>::Zero()};
  if (before == nullptr) return out;
  const Simplex<3> was = before->triangle(mesh.numbers()[static_cast<std::size_t>(found)]);
  out.carried_m = at - (w[0] * was[0] + w[1] * was[1] + w[2] * was[2]);
  return out;
}

bool within(const Simplex<3>& triangle, const TriangleTree& mesh, double reach_m) {
  bool found = false;
  mesh.tree().for_each_overlapping(grown(box_of(triangle), reach_m), [&](int t) {
    found = found || within(triangle, mesh.triangles()[static_cast<std::size_t>(t)], reach_m);
  });
  return found;
}

double squared_distance(const Point<3>& a, const Point<3>& b, const Point<3>& c, const Point<3>& d) {
  const Point<3> u = b - a, v = d - c, w = a - c;
  const double uu = u.squaredNorm(), vv = v.squaredNorm(), uv = u.dot(v), uw = u.dot(w), vw = v.dot(w);
  const auto unit = [](double x) { return std::clamp(x, 0.0, 1.0); };
  const double parallel = uu * vv - uv * uv;
  double s = parallel > 0 ? unit((uv * vw - uw * vv) / parallel) : 0, t = vv > 0 ? (uv * s + vw) / vv : 0;
  if (!(t >= 0 && t <= 1)) {
    t = unit(t);
    s = uu > 0 ? unit((uv * t - uw) / uu) : 0;
  } else if (!(vv > 0)) {
    s = uu > 0 ? unit(-uw / uu) : 0;
  }
  const double inner = (w + s * u - t * v).squaredNorm();
  // If the segments are nearly parallel, s is rounding noise; a pair that includes an end point is then nearest.
  const auto from = [&](const Point<3>& p, const Point<3>& start, const Point<3>& way, double squared) {
    const double share = squared > 0 ? unit(way.dot(p - start) / squared) : 0;
    return (p - start - share * way).squaredNorm();
  };
  return std::min({inner, from(a, c, v, vv), from(b, c, v, vv), from(c, a, u, uu), from(d, a, u, uu)});
}

double squared_distance(const Point<3>& a, const Point<3>& b, const Simplex<3>& v) {
  if (crossing<3>(a, b, v) != 0) return 0;
  return std::min({squared_distance(a, v), squared_distance(b, v), squared_distance(a, b, v[0], v[1]),
                   squared_distance(a, b, v[1], v[2]), squared_distance(a, b, v[2], v[0])});
}

bool within(const Simplex<3>& triangle, const Capsule& c, double reach_m) {
  const double most = c.radius_m + reach_m;
  return squared_distance(c.a, c.b, triangle) <= most * most;
}

bool within(const Simplex<3>& triangle, const Simplex<3>& other, double reach_m) {
  const double most = reach_m * reach_m;
  for (int i = 0; i < 3; ++i)
    if (squared_distance(triangle[i], triangle[(i + 1) % 3], other) <= most ||
        squared_distance(other[i], other[(i + 1) % 3], triangle) <= most)
      return true;
  return false;
}

}  // namespace clothbench::contact

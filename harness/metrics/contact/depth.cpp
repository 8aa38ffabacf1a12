#include "metrics/contact/depth.hpp"

#include <algorithm>
#include <limits>
#include <map>
#include <utility>

namespace clothbench::contact {
namespace {

/// Signed depths at the samples: the sign at all of them, the distance only where it is needed.
class SignedDepths {
 public:
  SignedDepths(std::vector<Point<3>> points, const TriangleTree& object, const InsideTest& inside)
      : points_(std::move(points)), object_(object), depth_(points_.size(), std::numeric_limits<double>::quiet_NaN()) {
    const Box& box = object.tree().box();
    for (const Point<3>& p : points_) inside_.push_back(box.contains(p) && inside(p));
  }
  const Point<3>& point(std::size_t i) const { return points_[i]; }
  bool inside(std::size_t i) const { return inside_[i]; }
  double depth(std::size_t i) {
    if (!(depth_[i] == depth_[i])) depth_[i] = (inside_[i] ? 1 : -1) * object_.distance(points_[i]);
    return depth_[i];
  }

 private:
  std::vector<Point<3>> points_;
  const TriangleTree& object_;
  std::vector<double> depth_;
  std::vector<bool> inside_;
};

}  // namespace

double clip_to_inside(const Simplex<3>& corners, const std::array<double, 3>& f, std::vector<Piece>& pieces) {
  const int count = static_cast<int>(std::count_if(f.begin(), f.end(), [](double x) { return x > 0; }));
  if (count == 0) return 0;
  if (count == 3) {
    pieces.push_back({area(corners), (f[0] + f[1] + f[2]) / 3});
    return 0;
  }
  // `lone` is the corner alone on its side; the line f = 0 cuts its edges at `a` and `b`.
  int lone = 0;
  while ((f[lone] > 0) != (count == 1)) ++lone;
  const int i = (lone + 1) % 3, j = (lone + 2) % 3;
  const auto cut = [&](int k) {
    return Point<3>(corners[lone] + f[lone] / (f[lone] - f[k]) * (corners[k] - corners[lone]));
  };
  const Point<3> a = cut(i), b = cut(j);
  if (count == 1) {
    pieces.push_back({area({corners[lone], a, b}), f[lone] / 3});
  } else {
    pieces.push_back({area({a, corners[i], corners[j]}), (f[i] + f[j]) / 3});
    pieces.push_back({area({a, corners[j], b}), f[j] / 3});
  }
  return (b - a).norm();
}

void summarize(std::vector<Piece>& pieces, double cloth_area_m2, Depth& depth) {
  std::sort(pieces.begin(), pieces.end(), [](const Piece& a, const Piece& b) { return a.depth_m < b.depth_m; });
  double moment = 0;
  for (const Piece& piece : pieces) {
    depth.area_m2 += piece.area_m2;
    moment += piece.area_m2 * piece.depth_m;
  }
  if (!(depth.area_m2 > 0)) return;
  depth.mean_m = moment / depth.area_m2;
  depth.area_fraction = depth.area_m2 / cloth_area_m2;
  double below = 0;
  for (const Piece& piece : pieces) {
    below += piece.area_m2;
    depth.p99_m = piece.depth_m;
    if (below >= 0.99 * depth.area_m2) break;
  }
}

MeshDepth::MeshDepth(const TriangleMeshView& cloth) : vertices_(cloth.vertex_count()) {
  std::map<std::array<std::uint32_t, 2>, std::uint32_t> index;
  for (const auto& corner : cloth.triangles) {
    auto& mine = triangle_edges_.emplace_back();
    for (int i = 0; i < 3; ++i) {
      const std::uint32_t a = corner[i], b = corner[(i + 1) % 3];
      const std::array ends{std::min(a, b), std::max(a, b)};
      const auto [entry, is_new] = index.try_emplace(ends, static_cast<std::uint32_t>(edges_.size()));
      if (is_new) edges_.push_back(ends);
      mine[i] = entry->second;
    }
  }
}

Depth MeshDepth::operator()(const TriangleMeshView& cloth, const TriangleTree& object, const InsideTest& inside) const {
  std::vector<Point<3>> points;
  points.reserve(vertices_ + edges_.size() + cloth.triangles.size());
  for (std::size_t v = 0; v < vertices_; ++v) points.push_back(cloth.vertex(v));
  for (const auto& [a, b] : edges_) points.push_back(0.5 * (cloth.vertex(a) + cloth.vertex(b)));
  for (std::size_t t = 0; t < cloth.triangles.size(); ++t) {
    const Simplex<3> v = cloth.triangle(t);
    points.push_back((v[0] + v[1] + v[2]) / 3);
  }
  SignedDepths samples(std::move(points), object, inside);

  Depth depth;
  double cloth_area = 0;
  std::vector<Piece> pieces;
  for (std::size_t t = 0; t < cloth.triangles.size(); ++t) {
    cloth_area += area(cloth.triangle(t));
    // Corners and midpoints alternate round the triangle; the centroid comes last.
    std::array<std::size_t, 7> sample;
    for (int i = 0; i < 3; ++i) {
      sample[2 * i] = cloth.triangles[t][i];
      sample[2 * i + 1] = vertices_ + triangle_edges_[t][i];
    }
    sample[6] = vertices_ + edges_.size() + t;
    for (int i = 0; i < 7; ++i) {
      if (!samples.inside(sample[i])) continue;
      const double here = samples.depth(sample[i]);
      depth.max_m = std::max(depth.max_m, here);
      if (i < 6 && i % 2 == 0) depth.vertex_max_m = std::max(depth.vertex_max_m, here);
    }
    for (int i = 0; i < 6; ++i) {
      const std::array s{sample[i], sample[(i + 1) % 6], sample[6]};
      if (!samples.inside(s[0]) && !samples.inside(s[1]) && !samples.inside(s[2])) continue;
      clip_to_inside({samples.point(s[0]), samples.point(s[1]), samples.point(s[2])},
                     {samples.depth(s[0]), samples.depth(s[1]), samples.depth(s[2])}, pieces);
    }
  }
  summarize(pieces, cloth_area, depth);
  return depth;
}

}  // namespace clothbench::contact

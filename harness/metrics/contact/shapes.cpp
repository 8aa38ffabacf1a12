#include "metrics/contact/shapes.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

namespace clothbench::contact {
namespace {

class Subdivision {
 public:
  Subdivision(std::span<const Capsule> shapes, double resolution_m) : shapes_(shapes), resolution_m_(resolution_m) {}

  void add(const Simplex<3>& v) {
    cloth_area_ += area(v);
    const Point<3> centre = (v[0] + v[1] + v[2]) / 3;
    const double radius = reach(v, centre);
    near_.clear();
    for (std::size_t k = 0; k < shapes_.size(); ++k)
      if (!(signed_distance(centre, shapes_[k]) > radius)) near_.push_back(k);
    if (near_.empty()) return;
    double longest = 0;
    for (int i = 0; i < 3; ++i) longest = std::max(longest, (v[(i + 1) % 3] - v[i]).norm());
    // At least one halving, so that the edge midpoints are samples at any resolution.
    int halvings = 1;
    while (halvings < kMaxHalvings && longest > std::ldexp(resolution_m_, halvings)) ++halvings;
    cut_by_.assign(shapes_.size(), false);
    visit(v, halvings);
    const auto pairs = std::count(cut_by_.begin(), cut_by_.end(), true);
    result_.contour.pairs += pairs;
    if (pairs > 0) ++result_.contour.cloth_triangles;
  }

  ShapesResult finish() {
    summarize(pieces_, cloth_area_, result_.depth);
    return std::move(result_);
  }

 private:
  static double reach(const Simplex<3>& v, const Point<3>& centre) {
    return std::max({(v[0] - centre).norm(), (v[1] - centre).norm(), (v[2] - centre).norm()});
  }

  /// Depth in the union and the capsule that gives it.
  double depth_at(const Point<3>& p, std::size_t* which = nullptr) {
    double depth = -std::numeric_limits<double>::infinity();
    for (const std::size_t k : near_) {
      const double here = -signed_distance(p, shapes_[k]);
      if (!(here > depth)) continue;
      depth = here;
      if (which) *which = k;
    }
    result_.depth.max_m = std::max(result_.depth.max_m, depth);
    return depth;
  }

  void visit(const Simplex<3>& v, int halvings) {
    const Point<3> centre = (v[0] + v[1] + v[2]) / 3;
    std::size_t which = 0;
    if (depth_at(centre, &which) < -reach(v, centre)) return;
    if (halvings == 0) {
      const double length = clip_to_inside(v, {depth_at(v[0]), depth_at(v[1]), depth_at(v[2])}, pieces_);
      result_.contour.length_m += length;
      if (length > 0) cut_by_[which] = true;
      return;
    }
    const Point<3> m0 = 0.5 * (v[0] + v[1]), m1 = 0.5 * (v[1] + v[2]), m2 = 0.5 * (v[2] + v[0]);
    visit({v[0], m0, m2}, halvings - 1);
    visit({m0, v[1], m1}, halvings - 1);
    visit({m2, m1, v[2]}, halvings - 1);
    visit({m0, m1, m2}, halvings - 1);
  }

  std::span<const Capsule> shapes_;
  double resolution_m_, cloth_area_ = 0;
  std::vector<std::size_t> near_;
  std::vector<bool> cut_by_;
  std::vector<Piece> pieces_;
  ShapesResult result_;
};

}  // namespace

double signed_distance(const Point<3>& p, const Capsule& c) {
  const Point<3> axis = c.b - c.a;
  const double along = axis.dot(p - c.a) / axis.squaredNorm();
  // A sphere has no axis: `along` is NaN, and a is the nearest point.
  const Point<3> foot = along > 0 ? Point<3>(c.a + std::min(along, 1.0) * axis) : c.a;
  return (p - foot).norm() - c.radius_m;
}

ShapesResult shapes_contact(const TriangleMeshView& cloth, std::span<const Capsule> shapes, double resolution_m) {
  Subdivision subdivision(shapes, resolution_m);
  for (std::size_t t = 0; t < cloth.triangles.size(); ++t) subdivision.add(cloth.triangle(t));
  ShapesResult result = subdivision.finish();
  for (std::size_t i = 0; i < cloth.vertex_count(); ++i) {
    double depth = 0;
    for (const Capsule& c : shapes) depth = std::max(depth, -signed_distance(cloth.vertex(i), c));
    result.inside.push_back(depth > 0);
    result.depth.vertex_max_m = std::max(result.depth.vertex_max_m, depth);
  }
  return result;
}

double default_resolution_m(std::span<const Capsule> shapes) {
  double least = std::numeric_limits<double>::infinity();
  for (const Capsule& c : shapes) least = std::min(least, c.radius_m);
  return least / 8;
}

}  // namespace clothbench::contact

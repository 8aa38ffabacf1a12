#include "metrics/contact/shapes.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include "metrics/contact/touch.hpp"

namespace clothbench::contact {
namespace {

constexpr int kMoreHalvings = 6;        // beyond the resolution, where the contour is
constexpr double kContourError = 5e-3;  // of a part's contour, between two levels
constexpr double kDepthError = 5e-3;    // of a part's mean depth

Point<3> nearest_on_axis(const Point<3>& p, const Capsule& c) {
  const Point<3> axis = c.b - c.a;
  const double along = axis.dot(p - c.a) / axis.squaredNorm();
  // A sphere has no axis: `along` is NaN, and a is the nearest point.
  return along > 0 ? Point<3>(c.a + std::min(along, 1.0) * axis) : c.a;
}

/// A gradient bound: the depth in a convex shape is concave, so over a triangle it is nowhere greater than the greatest
/// value at the corners of its tangent plane at the centre.
double greatest_possible_depth(const Simplex<3>& v, const Point<3>& centre, const Capsule& c) {
  const Point<3> out = centre - nearest_on_axis(centre, c);
  const double distance = out.norm();
  if (!(distance > 0)) return c.radius_m;
  double least = std::numeric_limits<double>::infinity();
  for (const Point<3>& corner : v) least = std::min(least, out.dot(corner - centre) / distance);
  return c.radius_m - distance - least;
}

class Subdivision {
 public:
  Subdivision(std::span<const Capsule> shapes, double resolution_m) : shapes_(shapes), resolution_m_(resolution_m) {}

  void add(const Simplex<3>& v) {
    const double contour_before = result_.contour.length_m;
    add_parts(v);
    if (!one_sphere()) return;
    const double arcs = contour_with_sphere(v, shapes_[near_[0]]);
    result_.contour.length_m = contour_before + arcs;
    if (!(arcs > 0)) return;
    ++result_.contour.pairs;
    ++result_.contour.cloth_triangles;
  }

  ShapesResult finish() {
    summarize(pieces_, cloth_area_, result_.depth);
    return std::move(result_);
  }

 private:
  void add_parts(const Simplex<3>& v) {
    cloth_area_ += area(v);
    const Point<3> centre = (v[0] + v[1] + v[2]) / 3;
    const double radius = reach(v, centre);
    near_.clear();
    for (std::size_t k = 0; k < shapes_.size(); ++k)
      if (!(signed_distance(centre, shapes_[k]) > radius) && !is_near(shapes_[k])) near_.push_back(k);
    if (near_.empty()) return;
    for (const std::size_t k : near_) {
      const Capsule& c = shapes_[k];
      result_.depth.max_m = std::max(result_.depth.max_m, c.radius_m - std::sqrt(squared_distance(c.a, c.b, v)));
    }
    double longest = 0;
    for (int i = 0; i < 3; ++i) longest = std::max(longest, (v[(i + 1) % 3] - v[i]).norm());
    // At least one halving, so that the edge midpoints are samples at any resolution.
    int halvings = 1;
    while (halvings < kMaxHalvings && longest > std::ldexp(resolution_m_, halvings)) ++halvings;
    cut_by_.assign(shapes_.size(), false);
    visit(v, halvings);
    if (one_sphere()) return;  // counted by add
    const auto pairs = std::count(cut_by_.begin(), cut_by_.end(), true);
    result_.contour.pairs += pairs;
    if (pairs > 0) ++result_.contour.cloth_triangles;
  }

  /// Whether nothing but one sphere can be reached from the triangle that was added last.
  bool one_sphere() const { return near_.size() == 1 && shapes_[near_[0]].a == shapes_[near_[0]].b; }

  bool is_near(const Capsule& c) const {
    return std::any_of(near_.begin(), near_.end(), [&](std::size_t k) {
      return shapes_[k].a == c.a && shapes_[k].b == c.b && shapes_[k].radius_m == c.radius_m;
    });
  }

  static double reach(const Simplex<3>& v, const Point<3>& centre) {
    return std::max({(v[0] - centre).norm(), (v[1] - centre).norm(), (v[2] - centre).norm()});
  }

  /// Depth in the union and the capsule that gives it.
  double depth_at(const Point<3>& p, std::size_t* which = nullptr) const {
    double depth = -std::numeric_limits<double>::infinity();
    for (const std::size_t k : near_) {
      const double here = -signed_distance(p, shapes_[k]);
      if (!(here > depth)) continue;
      depth = here;
      if (which) *which = k;
    }
    return depth;
  }

  void visit(const Simplex<3>& v, int halvings) {
    const Point<3> centre = (v[0] + v[1] + v[2]) / 3;
    std::size_t which = 0;
    if (depth_at(centre, &which) < -reach(v, centre)) return;
    if (halvings == 0) {
      const double length = add_inside(v, kMoreHalvings);
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

  double clip(const Simplex<3>& v, std::vector<Piece>& pieces) const {
    return clip_to_inside(v, {depth_at(v[0]), depth_at(v[1]), depth_at(v[2])}, pieces);
  }

  /// Whether a part wholly inside is small enough for its depth to be linear.
  bool linear(const Simplex<3>& v, const Point<3>& centre) const {
    const double at_centre = depth_at(centre), of_corners = (depth_at(v[0]) + depth_at(v[1]) + depth_at(v[2])) / 3;
    return std::abs(at_centre - of_corners) <= kDepthError * at_centre;
  }

  /// Adds what is inside of a part. A part is halved on until its contour and its mean depth hardly change. Returns the
  /// contour's length.
  double add_inside(const Simplex<3>& v, int halvings) {
    const Point<3> centre = (v[0] + v[1] + v[2]) / 3;
    bool reached = false, whole = false;
    for (const std::size_t k : near_) {
      const auto inside = [&](const Point<3>& p) { return signed_distance(p, shapes_[k]) < 0; };
      whole = whole || (inside(v[0]) && inside(v[1]) && inside(v[2]));
      reached = reached || greatest_possible_depth(v, centre, shapes_[k]) > 0;
    }
    if (!reached && !whole) return 0;
    if (halvings == 0 || (whole && linear(v, centre))) return clip(v, pieces_);
    std::vector<Piece> coarse, fine;
    const double straight = clip(v, coarse);
    const Point<3> m0 = 0.5 * (v[0] + v[1]), m1 = 0.5 * (v[1] + v[2]), m2 = 0.5 * (v[2] + v[0]);
    const std::array<Simplex<3>, 4> parts{{{v[0], m0, m2}, {m0, v[1], m1}, {m2, m1, v[2]}, {m0, m1, m2}}};
    double finer = 0;
    for (const Simplex<3>& part : parts) finer += clip(part, fine);
    if (straight > 0 && std::abs(finer - straight) <= kContourError * straight) {
      pieces_.insert(pieces_.end(), fine.begin(), fine.end());
      return finer;
    }
    finer = 0;
    for (const Simplex<3>& part : parts) finer += add_inside(part, halvings - 1);
    return finer;
  }

  std::span<const Capsule> shapes_;
  double resolution_m_, cloth_area_ = 0;
  std::vector<std::size_t> near_;
  std::vector<bool> cut_by_;
  std::vector<Piece> pieces_;
  ShapesResult result_;
};

}  // namespace

double signed_distance(const Point<3>& p, const Capsule& c) { return (p - nearest_on_axis(p, c)).norm() - c.radius_m; }

double contour_with_sphere(const Simplex<3>& v, const Capsule& sphere) {
  const Point<3> across = (v[1] - v[0]).cross(v[2] - v[0]);
  if (!(across.norm() > 0)) return 0;
  const Point<3> normal = across.normalized();
  const double height = normal.dot(sphere.a - v[0]), squared = sphere.radius_m * sphere.radius_m - height * height;
  if (!(squared > 0)) return 0;
  const double radius = std::sqrt(squared);
  const Point<3> centre = sphere.a - height * normal, x = (v[1] - v[0]).normalized(), y = normal.cross(x);
  std::vector<double> angles;
  for (int i = 0; i < 3; ++i) {
    // |p + t way| = radius for t in [0, 1)
    const Point<3> p = v[i] - centre, way = v[(i + 1) % 3] - v[i];
    const double a = way.squaredNorm(), half_b = p.dot(way), root = half_b * half_b - a * (p.squaredNorm() - squared);
    if (!(a > 0 && root > 0)) continue;
    for (const double t : {(-half_b - std::sqrt(root)) / a, (-half_b + std::sqrt(root)) / a}) {
      const Point<3> at = p + t * way;
      if (t >= 0 && t < 1) angles.push_back(std::atan2(y.dot(at), x.dot(at)));
    }
  }
  const auto in_triangle = [&](double angle) {
    const Point<3> p = centre + radius * (std::cos(angle) * x + std::sin(angle) * y);
    for (int i = 0; i < 3; ++i)
      if (!(normal.dot((v[(i + 1) % 3] - v[i]).cross(p - v[i])) >= 0)) return false;
    return true;
  };
  constexpr double kTurn = 2 * std::numbers::pi;
  if (angles.empty()) return in_triangle(0) ? kTurn * radius : 0;
  std::sort(angles.begin(), angles.end());
  double inside = 0;
  for (std::size_t k = 0; k < angles.size(); ++k) {
    const double from = angles[k], to = k + 1 < angles.size() ? angles[k + 1] : angles[0] + kTurn;
    if (in_triangle((from + to) / 2)) inside += to - from;
  }
  return inside * radius;
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

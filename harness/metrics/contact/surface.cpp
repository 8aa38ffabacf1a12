#include "metrics/contact/surface.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "metrics/contact/touch.hpp"

namespace clothbench::contact {
namespace {

double share(const Point<3>& p, const Capsule& c) {
  const Point<3> ab = c.b - c.a;
  const double squared = ab.squaredNorm();
  return squared > 0 ? std::clamp(ab.dot(p - c.a) / squared, 0.0, 1.0) : 0.0;
}

Point<3> direction(const Point<3>& v) {
  const double length = v.norm();
  return length > 0 ? Point<3>(v / length) : Point<3>(Point<3>::Zero());
}

}  // namespace

Nearest nearest(const Point<3>& p, std::span<const Capsule> now, std::span<const Capsule> before) {
  Nearest best{std::numeric_limits<double>::infinity(), Point<3>::Zero(), Point<3>::Zero()};
  for (std::size_t k = 0; k < now.size(); ++k) {
    const double t = share(p, now[k]);
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

NearSurface::NearSurface(const TriangleMeshView& now) : mesh_(now) {
  std::vector<Box> boxes;
  for (std::size_t t = 0; t < now.triangles.size(); ++t) {
    const Simplex<3> corner = now.triangle(t);
    if (is_degenerate(corner)) continue;
    source_.push_back(t);
    Box box(corner[0]);
    boxes.push_back(box.extend(corner[1]).extend(corner[2]));
  }
  tree_ = BoxTree(std::move(boxes));
}

std::optional<Nearest> NearSurface::operator()(const Point<3>& p, double bound_m,
                                               std::span<const double> before) const {
  double bound = bound_m * bound_m;
  const int found = tree_.nearest(
      p, bound, [&](int t) { return squared_distance(p, mesh_.triangle(source_[static_cast<std::size_t>(t)])); });
  if (found < 0) return std::nullopt;
  const std::size_t t = source_[static_cast<std::size_t>(found)];
  const Simplex<3> corner = mesh_.triangle(t);
  const Point<3> w = nearest_weights(p, corner), at = w[0] * corner[0] + w[1] * corner[1] + w[2] * corner[2];
  Nearest out{std::sqrt(bound), direction(p - at), Point<3>::Zero()};
  if (before.empty()) return out;
  const Simplex<3> was = TriangleMeshView{before, mesh_.triangles}.triangle(t);
  out.carried_m = at - (w[0] * was[0] + w[1] * was[1] + w[2] * was[2]);
  return out;
}

bool NearSurface::within(const Simplex<3>& triangle, double reach_m) const {
  const Box tight = Box(triangle[0]).extend(triangle[1]).extend(triangle[2]);
  const Point<3> out = Point<3>::Constant(reach_m);
  bool found = false;
  tree_.for_each_overlapping(Box(tight.min() - out, tight.max() + out), [&](int t) {
    found = found || contact::within(triangle, mesh_.triangle(source_[static_cast<std::size_t>(t)]), reach_m);
  });
  return found;
}

}  // namespace clothbench::contact

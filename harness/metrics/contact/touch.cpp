#include "metrics/contact/touch.hpp"

#include <algorithm>

namespace clothbench::contact {

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
  // Where the segments are nearly parallel, s is rounding noise; then a pair with an end of a segment is nearest.
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

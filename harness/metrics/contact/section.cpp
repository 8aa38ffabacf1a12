#include "metrics/contact/section.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include "metrics/contact/touch.hpp"

namespace clothbench::contact {
namespace {

constexpr double kShort = 1e-8;     // m: an arc as short as this is cut where its distance, taken as linear, is 0
constexpr double kParallel = 1e-8;  // sine of the angle between axis and plane below which the section is two lines
constexpr double kHalfTurn = std::numbers::pi;

Point<3> nearest_on_axis(const Point<3>& p, const Capsule& c) {
  const Point<3> axis = c.b - c.a;
  const double along = axis.dot(p - c.a) / axis.squaredNorm();
  // A sphere has no axis: `along` is NaN, and a is the nearest point.
  return along > 0 ? Point<3>(c.a + std::min(along, 1.0) * axis) : c.a;
}

}  // namespace

double signed_distance(const Point<3>& p, const Capsule& c) { return (p - nearest_on_axis(p, c)).norm() - c.radius_m; }

TriangleSection::TriangleSection(const Simplex<3>& triangle, std::span<const Capsule> shapes) : corners_(triangle) {
  const Point<3> across = (triangle[1] - triangle[0]).cross(triangle[2] - triangle[0]);
  flat_ = !(across.norm() > 0);
  for (std::size_t k = 0; k < shapes.size(); ++k) add(shapes[k], k);
  if (flat_ || parts_.empty()) return;
  normal_ = across.normalized();
  x_ = (triangle[1] - triangle[0]).normalized();
  y_ = normal_.cross(x_);
  for (std::size_t i = 0; i < 3; ++i) inward_[i] = normal_.cross(triangle[(i + 1) % 3] - triangle[i]).normalized();
}

void TriangleSection::add(const Capsule& c, std::size_t index) {
  // Most capsules are far away, which the boxes tell at less cost; the factor covers rounding.
  const Eigen::AlignedBox3d box = Eigen::AlignedBox3d(corners_[0]).extend(corners_[1]).extend(corners_[2]);
  const double apart = box.squaredExteriorDistance(Eigen::AlignedBox3d(c.a).extend(c.b));
  if (apart > c.radius_m * c.radius_m * (1 + 1e-12)) return;
  const double depth = c.radius_m - std::sqrt(squared_distance(c.a, c.b, corners_));
  if (!(depth > 0)) return;
  depth_m_ = std::max(depth_m_, depth);
  const auto add_part = [&](const Part& part) {
    // Capsules that share a joint share its ball, whose surface would count for none or for both.
    for (std::size_t k = 0; k < parts_.size(); ++k) {
      const Part& p = parts_[k];
      if (p.at != part.at || p.end != part.end || p.radius_m != part.radius_m) continue;
      reach_m_[k] = std::max(reach_m_[k], depth);
      return;
    }
    parts_.push_back(part);
    reach_m_.push_back(depth);
  };
  const Point<3> none = Point<3>::Zero(), axis = c.b - c.a;
  add_part({c.a, c.a, none, 0, c.radius_m, index});
  if (c.a == c.b) return;
  add_part({c.b, c.b, none, 0, c.radius_m, index});
  add_part({c.a, c.b, axis.normalized(), axis.norm(), c.radius_m, index});
}

std::vector<TriangleSection::Part> TriangleSection::deeper_than(double depth_m) const {
  std::vector<Part> out;
  for (std::size_t k = 0; k < parts_.size(); ++k) {
    if (!(reach_m_[k] > depth_m)) continue;
    out.push_back(parts_[k]);
    out.back().radius_m -= depth_m;
  }
  return out;
}

namespace {

template <typename Arc>
Point<3> point_at(const Arc& a, double t) {
  return a.centre + std::cos(t) * a.u + std::sin(t) * a.v;
}

template <typename Arc>
double longest(const Arc& a, double from, double to) {
  const bool through_fastest = std::floor(from / kHalfTurn) != std::floor(to / kHalfTurn);
  const double c = through_fastest ? 1 : std::max(std::abs(std::cos(from)), std::abs(std::cos(to)));
  return (to - from) * std::sqrt(a.u.squaredNorm() + c * c * a.v.squaredNorm());
}

/// Length of an arc. |v| is at least |u|, so that this is an elliptic integral of the second kind.
template <typename Arc>
double length(const Arc& a, double from, double to) {
  const double along = a.v.norm(), ratio = a.u.norm() / along;
  const double k = std::sqrt(std::max(0.0, (1 - ratio) * (1 + ratio)));
  if (k == 0) return along * (to - from);
  return along * (std::ellint_2(k, to) - std::ellint_2(k, from));
}

}  // namespace

/// Signed distance to a ball or a side, or less than that: it changes by no more than the way of `p` on `own`.
double TriangleSection::outside(const Point<3>& p, const Part& part, const Part& own) {
  const Point<3> out = p - part.at;
  const bool joined = part.radius_m == own.radius_m;
  if (part.length_m == 0) {
    // A side touches its own balls, and enters neither.
    if (joined && own.length_m > 0 && (part.at == own.at || part.at == own.end))
      return std::numeric_limits<double>::infinity();
    return out.norm() - part.radius_m;
  }
  const double s = part.along.dot(out);
  // Of a ball all that lies beside its own side is within it. The distance would say so too late: it is quadratic
  // there.
  if (joined && own.length_m == 0 && own.at == part.at) return -s;
  if (joined && own.length_m == 0 && own.at == part.end) return s - part.length_m;
  return std::max({(out - s * part.along).norm() - part.radius_m, -s, s - part.length_m});
}

std::vector<TriangleSection::Arc> TriangleSection::arcs(const Part& part) const {
  if (part.length_m > 0) return side_arcs(part);
  const double height = normal_.dot(part.at - corners_[0]), squared = part.radius_m * part.radius_m - height * height;
  if (!(squared > 0)) return {};
  const double radius = std::sqrt(squared);
  return {{part.at - height * normal_, radius * x_, radius * y_, 0, 2 * kHalfTurn}};
}

std::vector<TriangleSection::Arc> TriangleSection::side_arcs(const Part& part) const {
  const double sine = part.along.dot(normal_), height = normal_.dot(part.at - corners_[0]);
  const Point<3> level = part.along - sine * normal_;
  const double cosine = level.norm();
  const Point<3> w = cosine > 1e-12 ? Point<3>(level / cosine) : x_, m = normal_.cross(w);
  if (std::abs(sine) < kParallel) {
    const double above = height + 0.5 * part.length_m * sine;
    const double squared = part.radius_m * part.radius_m - above * above;
    if (!(squared > 0)) return {};
    const Point<3> middle = part.at + 0.5 * part.length_m * part.along - above * normal_,
                   aside = std::sqrt(squared) * m;
    const Point<3> half = 0.5 * part.length_m * w, none = Point<3>::Zero();
    return {{middle - aside, none, half, -kHalfTurn / 2, kHalfTurn / 2},
            {middle + aside, none, -half, -kHalfTurn / 2, kHalfTurn / 2}};
  }
  // An ellipse about the point where the axis meets the plane; `s` along the axis is met + far sin(t).
  const double met = -height / sine, major = part.radius_m / std::abs(sine), far = major * cosine;
  Arc arc{part.at + met * part.along, -part.radius_m * m, major * w, 0, 2 * kHalfTurn};
  if (!(far > 1e-12 * part.length_m)) {
    if (!(met >= 0 && met <= part.length_m)) return {};
    return {arc};
  }
  const double low = -met / far, high = (part.length_m - met) / far;
  if (!(low < 1 && high > -1)) return {};
  const double from = std::asin(std::max(low, -1.0)), to = std::asin(std::min(high, 1.0));
  arc.from = from, arc.to = to;
  Arc back = arc;
  back.from = kHalfTurn - to, back.to = kHalfTurn - from;
  return {arc, back};
}

std::vector<TriangleSection::Range> TriangleSection::kept(const Arc& arc, std::span<const Part> parts,
                                                          std::size_t own) const {
  const auto clear = [&](double t) {
    const Point<3> p = point_at(arc, t);
    double least = std::numeric_limits<double>::infinity();
    for (std::size_t i = 0; i < 3; ++i) least = std::min(least, inward_[i].dot(p - corners_[i]));
    for (std::size_t k = 0; k < parts.size(); ++k)
      if (k != own) least = std::min(least, outside(p, parts[k], parts[own]));
    return least;
  };
  std::vector<Range> out;
  const auto keep = [&](double from, double to) {
    if (!out.empty() && out.back().to == from)
      out.back().to = to;
    else
      out.push_back({from, to});
  };
  const auto visit = [&](const auto& self, double from, double to) -> void {
    const double middle = 0.5 * (from + to), at_middle = clear(middle), long_m = longest(arc, from, to);
    if (at_middle < -0.5 * long_m) return;
    if (at_middle > 0.5 * long_m) return keep(from, to);
    if (long_m > kShort && middle > from && middle < to) {
      self(self, from, middle);
      self(self, middle, to);
      return;
    }
    const double first = clear(from), last = clear(to);
    if ((first > 0) == (last > 0)) {
      if (at_middle > 0) keep(from, to);
      return;
    }
    const double zero = from + (to - from) * first / (first - last);
    if (first > 0)
      keep(from, zero);
    else
      keep(zero, to);
  };
  visit(visit, arc.from, arc.to);
  return out;
}

double TriangleSection::twice_area(const Point<3>& from, const Point<3>& to) const {
  return normal_.dot((from - corners_[0]).cross(to - corners_[0]));
}

std::vector<TriangleSection::Range> TriangleSection::inside_of_edge(int edge, std::span<const Part> parts) const {
  const auto i = static_cast<std::size_t>(edge);
  const Point<3>& from = corners_[i];
  const Point<3> way = corners_[(i + 1) % 3] - from;
  std::vector<Range> out;
  for (const Part& part : parts) {
    double first = 0, last = 1;
    const Point<3> start = from - part.at;
    Point<3> p = start, q = way;
    if (part.length_m > 0) {
      const double s = part.along.dot(start), ds = part.along.dot(way);
      p -= s * part.along, q -= ds * part.along;
      const double a = -s / ds, b = (part.length_m - s) / ds;
      if (ds == 0 && !(s >= 0 && s <= part.length_m)) continue;
      if (ds != 0) first = std::max(first, std::min(a, b)), last = std::min(last, std::max(a, b));
    }
    // |p + t q| < radius
    const double a = q.squaredNorm(), half_b = p.dot(q), c = p.squaredNorm() - part.radius_m * part.radius_m;
    if (a > 0) {
      const double root = half_b * half_b - a * c;
      if (!(root > 0)) continue;
      first = std::max(first, (-half_b - std::sqrt(root)) / a), last = std::min(last, (-half_b + std::sqrt(root)) / a);
    } else if (!(c < 0)) {
      continue;
    }
    if (first < last) out.push_back({first, last});
  }
  std::sort(out.begin(), out.end(), [](const Range& l, const Range& r) { return l.from < r.from; });
  return out;
}

double TriangleSection::edges_twice_area(std::span<const Part> parts) const {
  double sum = 0;
  for (int edge = 0; edge < 3; ++edge) {
    const auto i = static_cast<std::size_t>(edge);
    const Point<3>& from = corners_[i];
    const Point<3> way = corners_[(i + 1) % 3] - from;
    double done = 0;
    for (const Range& r : inside_of_edge(edge, parts)) {
      const double first = std::max(r.from, done);
      if (!(r.to > first)) continue;
      sum += twice_area(from + first * way, from + r.to * way);
      done = r.to;
    }
  }
  return sum;
}

double TriangleSection::area_deeper_m2(double depth_m) const {
  const std::vector<Part> parts = flat_ ? std::vector<Part>{} : deeper_than(depth_m);
  if (parts.empty()) return 0;
  // Green's theorem: the border runs anticlockwise about what is inside.
  double twice = edges_twice_area(parts);
  for (std::size_t k = 0; k < parts.size(); ++k)
    for (const Arc& arc : arcs(parts[k]))
      for (const Range& r : kept(arc, parts, k)) {
        const Point<3> chord = point_at(arc, r.to) - point_at(arc, r.from);
        twice += normal_.dot((arc.centre - corners_[0]).cross(chord) + (r.to - r.from) * arc.u.cross(arc.v));
      }
  return std::max(0.0, 0.5 * twice);
}

TriangleSection::Border TriangleSection::border() const {
  Border out;
  std::vector<bool> on;
  for (std::size_t k = 0; k < parts_.size() && !flat_; ++k)
    for (const Arc& arc : arcs(parts_[k]))
      for (const Range& r : kept(arc, parts_, k)) {
        out.length_m += length(arc, r.from, r.to);
        on.resize(std::max(on.size(), parts_[k].capsule + 1));
        on[parts_[k].capsule] = true;
      }
  out.capsules = std::count(on.begin(), on.end(), true);
  return out;
}

}  // namespace clothbench::contact

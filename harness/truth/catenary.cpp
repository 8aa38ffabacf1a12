#include "truth/catenary.hpp"

#include <algorithm>
#include <boost/math/special_functions/sinhc.hpp>
#include <cmath>

#include "truth/checks.hpp"
#include "truth/root.hpp"

namespace clothbench::truth {
namespace {

void check(double length, double span) {
  positive(length, "length_m");
  within(span / length, 1e-3, 1 - 1e-6, "span_m (over length_m)");
}

}  // namespace

Catenary::Catenary(double length, double span) : length_(length), span_(span) {
  check(length, span);
  // y = d/2a: sinh(y)/y = L/d, in logarithms for the steep end.
  const double target = std::log(length / span);
  const double y = positive_root([&](double v) { return std::log(boost::math::sinhc_pi(v)) - target; },
                                 std::sqrt(6 * target), true, "catenary");
  a_ = span / (2 * y);
}

double Catenary::sag_m() const {
  const double half = std::sinh(span_ / (4 * a_));
  return 2 * a_ * half * half;
}

std::array<double, 2> Catenary::position_m(double s) const {
  within(s, 0, length_, "rest_m");
  const double from_middle = s - length_ / 2, below = s * (length_ - s);  // (L/2)^2 - (s - L/2)^2
  return {span_ / 2 + a_ * std::asinh(from_middle / a_),
          -below / (std::hypot(a_, from_middle) + std::hypot(a_, length_ / 2))};
}

DiscreteCatenary::DiscreteCatenary(int links, double length, double span)
    : links_(at_least(links, 2, "links")), length_(length) {
  check(length, span);
  const double target = span / length;
  tension_ = positive_root(
      [&](double h) {
        double sum = 0;
        for (int i = 0; i < links_; ++i) sum += 1 / std::hypot(1.0, (i - 0.5 * (links_ - 1)) / (links_ * h));
        return sum / links_ - target;
      },
      Catenary(length, span).horizontal_tension(), true, "discrete catenary");
}

double DiscreteCatenary::tangent(int link) const { return (link - 0.5 * (links_ - 1)) / (links_ * tension_); }

std::vector<std::array<double, 2>> DiscreteCatenary::nodes_m() const {
  std::vector<std::array<double, 2>> nodes{{0, 0}};
  const double cell = length_ / links_;
  for (int i = 0; i < links_; ++i) {
    const double t = tangent(i), cosine = 1 / std::hypot(1.0, t);
    nodes.push_back({nodes.back()[0] + cell * cosine, nodes.back()[1] + cell * cosine * t});
  }
  return nodes;
}

double DiscreteCatenary::sag_m() const {
  double lowest = 0;
  for (const auto& node : nodes_m()) lowest = std::min(lowest, node[1]);
  return -lowest;
}

}  // namespace clothbench::truth

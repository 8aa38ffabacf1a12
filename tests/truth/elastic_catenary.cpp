#include "elastic_catenary.hpp"

#include <cmath>

#include "truth/checks.hpp"
#include "truth/root.hpp"

namespace clothbench::truth {

ElasticCatenary::ElasticCatenary(double length, double span, double areal_density, double membrane_stiffness,
                                 double gravity)
    : length_(positive(length, "length_m")),
      span_(positive(span, "span_m")),
      weight_(positive(areal_density, "areal_density_kg_per_m2") * positive(gravity, "gravity_m_per_s2")),
      stiffness_(positive(membrane_stiffness, "membrane_stiffness_N_per_m")) {
  within(span / length, 1e-3, 3, "span_m (over length_m)");
  const double total = weight_ * length, slack = total / stiffness_;
  // h = H/(wL): the span grows with it.
  const double h = positive_root([&](double v) { return v * slack + 2 * v * std::asinh(0.5 / v) - span / length; }, 0.3,
                                 true, "elastic catenary");
  tension_ = h * total;
}

double ElasticCatenary::sag_m() const { return -position_m(length_ / 2)[1]; }

double ElasticCatenary::strain(double s) const {
  within(s, 0, length_, "rest_m");
  return std::hypot(tension_, weight_ * (s - length_ / 2)) / stiffness_;
}

std::array<double, 2> ElasticCatenary::position_m(double s) const {
  within(s, 0, length_, "rest_m");
  const double a = tension_ / weight_, from_middle = s - length_ / 2, below = s * (length_ - s);
  return {span_ / 2 + from_middle * tension_ / stiffness_ + a * std::asinh(from_middle / a),
          -below * (weight_ / (2 * stiffness_) + 1 / (std::hypot(a, from_middle) + std::hypot(a, length_ / 2)))};
}

}  // namespace clothbench::truth

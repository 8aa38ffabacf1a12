#include "spin.hpp"

#include <cmath>
#include <numbers>

#include "truth/checks.hpp"

namespace clothbench::truth {
namespace {

double wave_number(const SpinningStrip& s, double rest_radius_m) {
  positive(s.half_length_m, "half_length_m");
  positive(s.areal_density_kg_per_m2, "areal_density_kg_per_m2");
  positive(s.membrane_stiffness_N_per_m, "membrane_stiffness_N_per_m");
  positive(s.angular_speed_rad_per_s, "angular_speed_rad_per_s");
  within(rest_radius_m, -s.half_length_m, s.half_length_m, "rest_radius_m");
  const double k = s.angular_speed_rad_per_s * std::sqrt(s.areal_density_kg_per_m2 / s.membrane_stiffness_N_per_m);
  between(k * s.half_length_m, 0, std::numbers::pi / 2,
          "angular_speed_rad_per_s (times half_length_m over wave speed)");
  return k;
}

}  // namespace

double spin_radius_m(const SpinningStrip& s, double x) {
  const double k = wave_number(s, x);
  return std::sin(k * x) / (k * std::cos(k * s.half_length_m));
}

double spin_strain(const SpinningStrip& s, double x) {
  const double k = wave_number(s, x), l = s.half_length_m;
  // cos(kx)/cos(kl) - 1, as a product: no cancellation for stiff strips.
  return 2 * std::sin(0.5 * k * (l + x)) * std::sin(0.5 * k * (l - x)) / std::cos(k * l);
}

std::array<double, 2> rotated(std::array<double, 2> p, double angular_speed, double t) {
  const double c = std::cos(angular_speed * t), s = std::sin(angular_speed * t);
  return {c * p[0] - s * p[1], s * p[0] + c * p[1]};
}

}  // namespace clothbench::truth

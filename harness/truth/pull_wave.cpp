#include "truth/pull_wave.hpp"

#include <cmath>
#include <numbers>

#include "truth/checks.hpp"

namespace clothbench::truth {
namespace {

using std::numbers::pi;

void check(const TwoHandPull& p, double t) {
  positive(p.length_m, "length_m");
  positive(p.areal_density_kg_per_m2, "areal_density_kg_per_m2");
  positive(p.membrane_stiffness_N_per_m, "membrane_stiffness_N_per_m");
  positive(p.hand_speed_m_per_s, "hand_speed_m_per_s");
  non_negative(p.ramp_s, "ramp_s");
  non_negative(t, "time_s");
}

// Unchecked, 0 before t = 0.
double way_at(const TwoHandPull& p, double t) {
  if (t <= 0) return 0;
  if (t >= p.ramp_s) return p.hand_speed_m_per_s * (t - 0.5 * p.ramp_s);
  return 0.5 * p.hand_speed_m_per_s * (t - p.ramp_s / pi * std::sin(pi * t / p.ramp_s));
}

}  // namespace

double wave_speed_m_per_s(const TwoHandPull& p) {
  check(p, 0);
  return std::sqrt(p.membrane_stiffness_N_per_m / p.areal_density_kg_per_m2);
}

double hand_way_m(const TwoHandPull& p, double t) {
  check(p, t);
  return way_at(p, t);
}

double pull_displacement_m(const TwoHandPull& p, double x, double t) {
  check(p, t);
  const double half = p.length_m / 2, c = wave_speed_m_per_s(p);
  within(x, -half, half, "rest_x_m");
  double sum = 0;
  for (double path = half; path - half <= c * t; path += p.length_m)
    sum += way_at(p, t - (path - x) / c) - way_at(p, t - (path + x) / c);
  return sum;
}

}  // namespace clothbench::truth

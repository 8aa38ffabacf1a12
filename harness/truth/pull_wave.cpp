#include "truth/pull_wave.hpp"

#include <algorithm>
#include <boost/math/tools/minima.hpp>
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
double speed_at(const TwoHandPull& p, double t) {
  if (t < 0) return 0;
  if (t >= p.ramp_s) return p.hand_speed_m_per_s;
  const double rise = std::sin(0.5 * pi * t / p.ramp_s);
  return p.hand_speed_m_per_s * rise * rise;
}

double way_at(const TwoHandPull& p, double t) {
  if (t <= 0) return 0;
  if (t >= p.ramp_s) return p.hand_speed_m_per_s * (t - 0.5 * p.ramp_s);
  return 0.5 * p.hand_speed_m_per_s * (t - p.ramp_s / pi * std::sin(pi * t / p.ramp_s));
}

/// Sum over images of value(right hand's wave) + sign * value(left hand's).
template <class Value>
double over_images(const TwoHandPull& p, double x, double t, double sign, Value value) {
  check(p, t);
  const double half = p.length_m / 2, c = wave_speed_m_per_s(p);
  within(x, -half, half, "rest_x_m");
  double sum = 0;
  for (double path = half; path - half <= c * t; path += p.length_m)
    sum += value(p, t - (path - x) / c) + sign * value(p, t - (path + x) / c);
  return sum;
}

}  // namespace

double wave_speed_m_per_s(const TwoHandPull& p) {
  check(p, 0);
  return std::sqrt(p.membrane_stiffness_N_per_m / p.areal_density_kg_per_m2);
}

double pull_ramp_s(const TwoHandPull& p) { return p.length_m / wave_speed_m_per_s(p); }

double hand_speed_m_per_s(const TwoHandPull& p, double t) {
  check(p, t);
  return speed_at(p, t);
}

double hand_way_m(const TwoHandPull& p, double t) {
  check(p, t);
  return way_at(p, t);
}

int reflections(const TwoHandPull& p, double t) {
  check(p, t);
  return static_cast<int>(
      within(std::floor(wave_speed_m_per_s(p) * t / (p.length_m / 2)), 0, 1e9, "time_s (in crossings)"));
}

double pull_strain(const TwoHandPull& p, double x, double t) {
  return over_images(p, x, t, 1, speed_at) / wave_speed_m_per_s(p);
}

double pull_displacement_m(const TwoHandPull& p, double x, double t) { return over_images(p, x, t, -1, way_at); }

double pull_speed_m_per_s(const TwoHandPull& p, double x, double t) { return over_images(p, x, t, -1, speed_at); }

double mean_pull_strain(const TwoHandPull& p, double t) { return hand_way_m(p, t) / (p.length_m / 2); }

double greatest_pull_strain(const TwoHandPull& p, double t) {
  // With a step, wave n + 1 is on its way: there is a place with n + 1 passes, however narrow.
  if (p.ramp_s == 0) return (1 + reflections(p, t)) * p.hand_speed_m_per_s / wave_speed_m_per_s(p);
  constexpr int kPoints = 2048;
  const double step = p.length_m / 2 / kPoints;
  int best = 0;
  double greatest = 0;
  for (int i = 0; i <= kPoints; ++i) {
    const double strain = pull_strain(p, i * step, t);
    if (strain > greatest) {
      greatest = strain;
      best = i;
    }
  }
  const auto found =
      boost::math::tools::brent_find_minima([&](double x) { return -pull_strain(p, x, t); },
                                            std::max(0, best - 1) * step, std::min(kPoints, best + 1) * step, 40);
  return std::max(greatest, -found.second);
}

double release_speed_m_per_s(double strain, double areal_density, double membrane_stiffness) {
  return non_negative(strain, "strain") * std::sqrt(positive(membrane_stiffness, "membrane_stiffness_N_per_m") /
                                                    positive(areal_density, "areal_density_kg_per_m2"));
}

}  // namespace clothbench::truth

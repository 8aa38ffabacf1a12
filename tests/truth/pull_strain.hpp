// Strain and speed of a strip that two hands pull, for the tests of its displacement and for published rows.
#pragma once
#include <algorithm>
#include <boost/math/tools/minima.hpp>
#include <cmath>
#include <numbers>

#include "truth/pull_wave.hpp"

namespace clothbench::truth {

/// Speed of a hand, 0 before t = 0.
inline double speed_at(const TwoHandPull& p, double t) {
  if (t < 0) return 0;
  if (t >= p.ramp_s) return p.hand_speed_m_per_s;
  const double rise = std::sin(0.5 * std::numbers::pi * t / p.ramp_s);
  return p.hand_speed_m_per_s * rise * rise;
}

/// (1/c) sum over images of v(right hand's wave) + sign * v(left hand's); TwoHandPull has the source.
inline double over_images(const TwoHandPull& p, double x, double t, double sign) {
  const double half = p.length_m / 2, c = wave_speed_m_per_s(p);
  double sum = 0;
  for (double path = half; path - half <= c * t; path += p.length_m)
    sum += speed_at(p, t - (path - x) / c) + sign * speed_at(p, t - (path + x) / c);
  return sum;
}

/// 2 l/c: long enough for 31 cells to follow within 1 %.
inline double pull_ramp_s(const TwoHandPull& p) { return p.length_m / wave_speed_m_per_s(p); }

/// Arrivals at the middle or an end so far: floor(c t/l).
inline int reflections(const TwoHandPull& p, double t) {
  return static_cast<int>(std::floor(wave_speed_m_per_s(p) * t / (p.length_m / 2)));
}

inline double pull_strain(const TwoHandPull& p, double x, double t) {
  return over_images(p, x, t, 1) / wave_speed_m_per_s(p);
}

inline double pull_speed_m_per_s(const TwoHandPull& p, double x, double t) { return over_images(p, x, t, -1); }

/// Greatest strain along the strip. With a ramp, by search on a grid of 2048 points and Brent's method: 1e-9 relative.
inline double greatest_pull_strain(const TwoHandPull& p, double t) {
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

}  // namespace clothbench::truth

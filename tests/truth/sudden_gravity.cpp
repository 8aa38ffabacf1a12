#include "sudden_gravity.hpp"

#include <cmath>

#include "truth/checks.hpp"

namespace clothbench::truth {
namespace {

struct Wave {
  double period, speed, phase;  ///< phase: time within the period
};

Wave wave(const SuddenGravity& s, double rest, double t) {
  positive(s.length_m, "length_m");
  positive(s.areal_density_kg_per_m2, "areal_density_kg_per_m2");
  positive(s.membrane_stiffness_N_per_m, "membrane_stiffness_N_per_m");
  positive(s.gravity_m_per_s2, "gravity_m_per_s2");
  within(rest, 0, s.length_m, "rest_m");
  const double c = std::sqrt(s.membrane_stiffness_N_per_m / s.areal_density_kg_per_m2);
  const double period = 4 * s.length_m / c;
  return {period, c, std::fmod(non_negative(t, "time_s"), period)};
}

// Sum over the two waves of each image met within one period: value(delay, sign of d/ds of the delay).
template <class Value>
double over_images(const SuddenGravity& s, double rest, const Wave& w, Value value) {
  double sum = 0;
  for (int k = 0; k < 2; ++k) {
    const double away = (2 * k * s.length_m + rest) / w.speed, back = (2 * (k + 1) * s.length_m - rest) / w.speed;
    const double sign = k % 2 ? -1 : 1;
    if (w.phase > away) sum += sign * value(w.phase - away, 1);
    if (w.phase > back) sum += sign * value(w.phase - back, -1);
  }
  return sum;
}

}  // namespace

double sudden_gravity_period_s(const SuddenGravity& s) { return wave(s, 0, 0).period; }

double sudden_gravity_displacement_m(const SuddenGravity& s, double rest, double t) {
  const Wave w = wave(s, rest, t);
  return 0.5 * s.gravity_m_per_s2 *
         (w.phase * w.phase - over_images(s, rest, w, [](double since, int) { return since * since; }));
}

double sudden_gravity_speed_m_per_s(const SuddenGravity& s, double rest, double t) {
  const Wave w = wave(s, rest, t);
  return s.gravity_m_per_s2 * (w.phase - over_images(s, rest, w, [](double since, int) { return since; }));
}

double sudden_gravity_strain(const SuddenGravity& s, double rest, double t) {
  const Wave w = wave(s, rest, t);
  return s.gravity_m_per_s2 / w.speed * over_images(s, rest, w, [](double since, int away) { return away * since; });
}

}  // namespace clothbench::truth

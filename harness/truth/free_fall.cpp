#include "truth/free_fall.hpp"

#include <cmath>

#include "truth/checks.hpp"

namespace clothbench::truth {
namespace {

double p1(double x) { return x == 0 ? 1 : -std::expm1(-x) / x; }

double p2(double x) {
  if (x > 1) return (x + std::expm1(-x)) / (x * x);
  // sum of (-x)^k / (k + 2)!: the closed form loses all digits near 0.
  double term = 0.5, sum = 0;
  for (int k = 0; k < 20; ++k) {
    sum += term;
    term *= -x / (k + 3);
  }
  return sum;
}

void check(const FreeFall& f, double time_s) {
  within(f.height_m, -1e300, 1e300, "height_m");
  within(f.speed_m_per_s, -1e300, 1e300, "speed_m_per_s");
  non_negative(f.gravity_m_per_s2, "gravity_m_per_s2");
  non_negative(f.damping_per_s, "damping_per_s");
  non_negative(time_s, "time_s");
}

}  // namespace

double fall_height_m(const FreeFall& f, double t) {
  check(f, t);
  const double x = f.damping_per_s * t;
  return f.height_m + f.speed_m_per_s * t * p1(x) - f.gravity_m_per_s2 * t * t * p2(x);
}

double fall_speed_m_per_s(const FreeFall& f, double t) {
  check(f, t);
  const double x = f.damping_per_s * t;
  return f.speed_m_per_s * std::exp(-x) - f.gravity_m_per_s2 * t * p1(x);
}

}  // namespace clothbench::truth

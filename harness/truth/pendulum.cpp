#include "truth/pendulum.hpp"

#include <boost/math/special_functions/ellint_1.hpp>
#include <boost/math/special_functions/jacobi_elliptic.hpp>
#include <cmath>
#include <numbers>

#include "truth/checks.hpp"

namespace clothbench::truth {
namespace {

double check(const Pendulum& p) {
  positive(p.length_m, "length_m");
  positive(p.gravity_m_per_s2, "gravity_m_per_s2");
  between(p.amplitude_rad, 0, std::numbers::pi, "amplitude_rad");
  return std::sqrt(p.gravity_m_per_s2 / p.length_m);
}

}  // namespace

double pendulum_period_s(const Pendulum& p) {
  return 4 * boost::math::ellint_1(std::sin(p.amplitude_rad / 2)) / check(p);
}

double pendulum_angle_rad(const Pendulum& p, double t) {
  const double rate = check(p), k = std::sin(p.amplitude_rad / 2);
  t = std::fmod(non_negative(t, "time_s"), pendulum_period_s(p));
  return 2 * std::asin(k * boost::math::jacobi_cd(k, rate * t));
}

double pendulum_angular_speed_rad_per_s(const Pendulum& p, double t) {
  const double rate = check(p), k = std::sin(p.amplitude_rad / 2);
  t = std::fmod(non_negative(t, "time_s"), pendulum_period_s(p));
  // d/du asin(k cd u) = -k k' sd u, since 1 - k^2 cd^2 = (k'/dn)^2.
  return -2 * k * std::cos(p.amplitude_rad / 2) * rate * boost::math::jacobi_sd(k, rate * t);
}

}  // namespace clothbench::truth

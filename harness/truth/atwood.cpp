#include "truth/atwood.hpp"

#include <cmath>
#include <numbers>

#include "clothbench/error.hpp"
#include "truth/checks.hpp"
#include "truth/root.hpp"

namespace clothbench::truth {
namespace {

double rate(const Atwood& a) {
  positive(a.length_m, "length_m");
  non_negative(a.radius_m, "radius_m");
  positive(a.gravity_m_per_s2, "gravity_m_per_s2");
  positive(a.offset_m, "offset_m");
  if (!(2 * a.offset_m + std::numbers::pi * a.radius_m < a.length_m))
    throw Error("argument offset_m: expected 2 offset_m + pi radius_m < length_m, so that both ends hang");
  return std::sqrt(2 * a.gravity_m_per_s2 / a.length_m);
}

}  // namespace

double atwood_end_s(const Atwood& a) {
  const double k = rate(a), overhang = 0.5 * (a.length_m - std::numbers::pi * a.radius_m);
  // (l - s)(g + k^2 s) - s'^2 falls, and is negative at the latest when the end has arrived (s = l): one root for both.
  const auto grip = [&](double t) {
    const double s = a.offset_m * std::cosh(k * t), v = a.offset_m * k * std::sinh(k * t);
    return (overhang - s) * (a.gravity_m_per_s2 + k * k * s) - v * v;
  };
  return positive_root(grip, 1 / k, false, "atwood");
}

double atwood_offset_m(const Atwood& a, double t) {
  within(t, 0, atwood_end_s(a), "time_s");
  return a.offset_m * std::cosh(rate(a) * t);
}

double atwood_speed_m_per_s(const Atwood& a, double t) {
  within(t, 0, atwood_end_s(a), "time_s");
  return a.offset_m * rate(a) * std::sinh(rate(a) * t);
}

}  // namespace clothbench::truth

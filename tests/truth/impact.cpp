#include "impact.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "truth/checks.hpp"

namespace clothbench::truth {
namespace {

void check(const Drop& d) {
  positive(d.height_m, "height_m");
  within(d.restitution, 0, 1, "restitution");
  positive(d.gravity_m_per_s2, "gravity_m_per_s2");
}

}  // namespace

double contact_time_s(const Drop& d) {
  check(d);
  return std::sqrt(2 * d.height_m / d.gravity_m_per_s2);
}

double contact_speed_m_per_s(const Drop& d) {
  check(d);
  return std::sqrt(2 * d.height_m * d.gravity_m_per_s2);
}

double rebound_height_m(const Drop& d, int bounce) {
  check(d);
  return d.height_m * std::pow(d.restitution, 2 * at_least(bounce, 1, "bounce"));
}

double rest_time_s(const Drop& d) {
  if (d.restitution == 1) return std::numeric_limits<double>::infinity();
  return contact_time_s(d) * (1 + d.restitution) / (1 - d.restitution);
}

double height_above_plane_m(const Drop& d, double t) {
  const double fall = contact_time_s(d), e = d.restitution;
  non_negative(t, "time_s");
  if (t >= rest_time_s(d)) return 0;
  if (t < fall) return d.height_m - 0.5 * d.gravity_m_per_s2 * t * t;
  // Flights of 2 fall e^k, k = 1, 2, ...; the k-th begins at fall (1 + 2 (e + ... + e^(k-1))).
  double since = t - fall, flight = 2 * fall * e;
  if (e == 1) since = std::fmod(since, flight);
  while (since > flight) {
    since -= flight;
    flight *= e;
  }
  return std::max(0.0, 0.5 * d.gravity_m_per_s2 * since * (flight - since));
}

}  // namespace clothbench::truth

#include "truth/incline.hpp"

#include <cmath>
#include <limits>
#include <numbers>

#include "truth/checks.hpp"

namespace clothbench::truth {
namespace {

void check(const Incline& i) {
  within(i.angle_rad, 0, std::nextafter(std::numbers::pi / 2, 0), "angle_rad");
  non_negative(i.friction, "friction");
  non_negative(i.speed_m_per_s, "speed_m_per_s");
  positive(i.gravity_m_per_s2, "gravity_m_per_s2");
}

// Both for a body that moves at first and one at rest that slips.
bool moves_at(const Incline& i, double t) {
  if (i.speed_m_per_s == 0) return !sticks(i);
  return t < stop(i).time_s;
}

}  // namespace

bool sticks(const Incline& i) {
  check(i);
  return std::tan(i.angle_rad) <= i.friction;
}

double sliding_acceleration_m_per_s2(const Incline& i) {
  check(i);
  return i.gravity_m_per_s2 * (std::sin(i.angle_rad) - i.friction * std::cos(i.angle_rad));
}

Stop stop(const Incline& i) {
  const double slowing = -sliding_acceleration_m_per_s2(i), v = i.speed_m_per_s;
  if (v == 0 && sticks(i)) return {true, 0, 0};
  if (!(slowing > 0)) return {false, std::numeric_limits<double>::infinity(), std::numeric_limits<double>::infinity()};
  return {true, v * v / (2 * slowing), v / slowing};
}

double slide_distance_m(const Incline& i, double t) {
  non_negative(t, "time_s");
  if (!moves_at(i, t)) return stop(i).distance_m;
  return t * (i.speed_m_per_s + 0.5 * sliding_acceleration_m_per_s2(i) * t);
}

double slide_speed_m_per_s(const Incline& i, double t) {
  non_negative(t, "time_s");
  return moves_at(i, t) ? i.speed_m_per_s + sliding_acceleration_m_per_s2(i) * t : 0;
}

}  // namespace clothbench::truth

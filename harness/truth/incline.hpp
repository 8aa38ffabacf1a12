#pragma once

namespace clothbench::truth {

/// A cloth lies flat on a plane at `angle` from the horizontal and starts downhill at `speed`, with Coulomb friction
/// between cloth and plane. At rest it sticks iff tan(angle) <= mu. A sliding cloth has the acceleration a = g (sin -
/// mu cos). If a is negative it stops after the distance v^2/(2|a|) at the time v/|a| and stays at rest. Source:
/// Coulomb 1781. Exact for a flat cloth in pure sliding. Valid for 0 <= angle < pi/2, mu >= 0, speed >= 0, g > 0; Error
/// otherwise. Errors of rounding only.
struct Incline {
  double angle_rad = 0;
  double friction = 0;
  double speed_m_per_s = 0;
  double gravity_m_per_s2 = 9.81;
};

bool sticks(const Incline&);                           ///< once at rest
double sliding_acceleration_m_per_s2(const Incline&);  ///< downhill, while sliding; negative if it slows down

struct Stop {
  bool stops;
  double distance_m, time_s;  ///< infinite if it doesn't
};
Stop stop(const Incline&);

/// Distance downhill [m] and speed [m/s] after `time_s`.
double slide_distance_m(const Incline&, double time_s);
double slide_speed_m_per_s(const Incline&, double time_s);

}  // namespace clothbench::truth

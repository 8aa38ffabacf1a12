#pragma once

namespace clothbench::truth {

/// A cloth that lies flat on a plane at `angle` from the horizontal and starts at `speed` downhill, with Coulomb
/// friction of the pair cloth-plane. It sticks at rest iff tan(angle) <= mu; sliding it gains g (sin - mu cos) and,
/// where that is negative, stops after v^2/(2|a|) at v/|a| and stays at rest. Source: Coulomb 1781. Exact for a flat
/// cloth in pure sliding. Valid for 0 <= angle < pi/2, mu >= 0, speed >= 0, g > 0; Error otherwise. Errors of rounding
/// only.
struct Incline {
  double angle_rad = 0;
  double friction = 0;
  double speed_m_per_s = 0;
  double gravity_m_per_s2 = 9.81;
};

double critical_angle_rad(double friction);
bool sticks(const Incline&);                           ///< once at rest
double sliding_acceleration_m_per_s2(const Incline&);  ///< downhill, of a cloth that slides; negative if it slows down

struct Stop {
  bool stops;
  double distance_m, time_s;  ///< infinite if it doesn't
};
Stop stop(const Incline&);

/// Way downhill [m] and speed [m/s] after `time_s`.
double slide_distance_m(const Incline&, double time_s);
double slide_speed_m_per_s(const Incline&, double time_s);

}  // namespace clothbench::truth

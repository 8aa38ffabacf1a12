#pragma once

namespace clothbench::truth {

/// Plane pendulum released at rest: theta'' = -(g/l) sin theta, theta from the vertical.
///   T = 4 sqrt(l/g) K(k),  sin(theta/2) = k cd(sqrt(g/l) t, k),  k = sin(amplitude/2)
/// with Jacobi's elliptic function cd. Source: Abramowitz & Stegun 16 and 17; Landau & Lifshitz, Mechanics, par. 11.
/// Valid for 0 < amplitude < pi at any t >= 0 (t is reduced by the period, so the period's relative rounding error
/// enters); Error otherwise.
struct Pendulum {
  double length_m = 1;  ///< of the equivalent point pendulum: moment of inertia over (mass * centre distance)
  double gravity_m_per_s2 = 9.81;
  double amplitude_rad = 0;
};

double pendulum_period_s(const Pendulum&);
double pendulum_angle_rad(const Pendulum&, double time_s);
double pendulum_angular_speed_rad_per_s(const Pendulum&, double time_s);

}  // namespace clothbench::truth

#pragma once

namespace clothbench::truth {

/// A free body in uniform gravity with damping proportional to its mass: dv/dt = -g - c v (upwards is positive). Every
/// point of a cloth without internal motion follows it, whatever its stiffness.
/// Source: Newton's second law; the damped case is a linear equation with solution
///   v = v0 e^{-ct} - g (1 - e^{-ct})/c,   z = z0 + v0 t p1(ct) - g t^2 p2(ct),
///   p1(x) = (1 - e^{-x})/x,  p2(x) = (x - 1 + e^{-x})/x^2  (1 and 1/2 at x = 0).
/// Valid for any t >= 0; errors of rounding only. Throws Error for g < 0, c < 0 or t < 0.
struct FreeFall {
  double height_m = 0;
  double speed_m_per_s = 0;  ///< upwards
  double gravity_m_per_s2 = 9.81;
  double damping_per_s = 0;
};

double fall_height_m(const FreeFall&, double time_s);
double fall_speed_m_per_s(const FreeFall&, double time_s);  ///< upwards

}  // namespace clothbench::truth

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

/// Height given by semi-implicit (symplectic) Euler with step dt at a time t = k dt, exactly: z0 + v0 t - g t (t +
/// dt)/2. Order 1; also holds for PBD and XPBD without damping. Throws Error if there is damping or t is not a multiple
/// of the step to 1e-9.
double semi_implicit_fall_height_m(const FreeFall&, double time_s, double step_s);

}  // namespace clothbench::truth

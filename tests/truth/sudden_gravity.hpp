#pragma once

namespace clothbench::truth {

/// An unstretched strip held at its upper edge (s = 0), small strains, on which gravity is switched on at t = 0:
/// u_tt = c^2 u_ss + g, u(0, t) = 0, u_s(L, t) = 0, c = sqrt(Y/rho). By images (d'Alembert), with
/// f(t) = -g t^2/2 for t > 0 and 0 before:
///   u = g t^2/2 + sum_k (-1)^k [ f(t - (2kL + s)/c) + f(t - (2(k+1)L - s)/c) ].
/// End: g t^2/2 up to t = L/c, then g t^2/2 - g (t - L/c)^2 up to 3L/c; greatest 2 * static = g L^2/c^2 at 2L/c; period
/// 4L/c. Source: wave equation (e.g. Graff, Wave Motion in Elastic Solids, ch. 2). Exact for engineering-strain springs
/// in the continuum limit; a chain of n cells adds dispersion. Valid for any t >= 0, 0 <= s <= L; errors of rounding
/// only. Throws Error for other arguments.
struct SuddenGravity {
  double length_m = 1;
  double areal_density_kg_per_m2 = 0.2;
  double membrane_stiffness_N_per_m = 1000;
  double gravity_m_per_s2 = 9.81;
};

double sudden_gravity_period_s(const SuddenGravity&);
double sudden_gravity_displacement_m(const SuddenGravity&, double rest_m, double time_s);
double sudden_gravity_speed_m_per_s(const SuddenGravity&, double rest_m, double time_s);
double sudden_gravity_strain(const SuddenGravity&, double rest_m, double time_s);

}  // namespace clothbench::truth

#pragma once

namespace clothbench::truth {

// Angular frequencies [rad/s] of small vibrations; modes count from 1. Errors are of rounding (1e-13 relative) unless
// stated. Throws Error unless lengths, densities, tensions and gravity are positive and modes 1 or more. At an
// amplitude of 2 % of the length the error of linearisation is of the order 1e-4.

/// Hanging inextensible strip: J0(2 w sqrt(L/g)) = 0, w = (j_{0,n}/2) sqrt(g/L).
/// Source: D. Bernoulli 1733.
double hanging_strip_frequency(int mode, double length_m, double gravity_m_per_s2);

/// The same for n links with equal inner masses and an end mass `end_mass_ratio` times as great (1/2: lumped cells),
/// from the eigenvalues of its tridiagonal matrix. For equal masses w^2 = (g n/L) * (zeros of the Laguerre polynomial
/// L_n) (D. Bernoulli). Order 2 in 1/n for 1/2, order 1 for 1. mode <= links.
double hanging_chain_frequency(int mode, int links, double length_m, double gravity_m_per_s2,
                               double end_mass_ratio = 0.5);

/// Transverse vibration of a strip under uniform tension T [N/m], held on both short edges: n pi/L sqrt(T/rho), and for
/// n cells of lumped mass 2 sqrt(T/rho)/a sin(n pi/(2 cells)), mode < cells. Source: Lagrange; Rayleigh, Theory of
/// Sound, ch. 6.
double taut_string_frequency(int mode, double length_m, double tension_N_per_m, double areal_density_kg_per_m2);
double taut_chain_frequency(int mode, int cells, double length_m, double tension_N_per_m,
                            double areal_density_kg_per_m2);

/// Rectangular membrane under uniform tension, edges held: pi sqrt(T/rho) sqrt((m/a)^2 + (n/b)^2).
/// Source: Rayleigh, Theory of Sound, ch. 9.
double membrane_frequency(int mode_a, int mode_b, double side_a_m, double side_b_m, double tension_N_per_m,
                          double areal_density_kg_per_m2);

/// Static sag [m] of its middle under its weight: solution of T lap u = -rho g as a series (Timoshenko & Goodier,
/// Theory of Elasticity, ch. 10, Prandtl's analogy). 0.0736714 rho g a^2/T for a square. Small slopes; the series is
/// summed to rounding.
double membrane_sag_m(double side_a_m, double side_b_m, double tension_N_per_m, double areal_density_kg_per_m2,
                      double gravity_m_per_s2);

/// Roots of cos(b) cosh(b) = -1 in ascending order.
double cantilever_root(int mode);

/// Cantilever strip without gravity: root^2 sqrt(B/(rho L^4)). Source: Euler-Bernoulli; Rayleigh, Theory of Sound,
/// ch. 8.
double cantilever_frequency(int mode, double length_m, double bending_rigidity_N_m, double areal_density_kg_per_m2);

/// Numerical damping of an undamped mode of frequency w under implicit Euler with step dt, z = w dt: amplitude ratio
/// per step 1/sqrt(1 + z^2), frequency over w atan(z)/z, and amplitude ratio per numerical period. Fully converged XPBD
/// is the same integrator. Source: eigenvalues 1/(1 -+ iz) of the step.
struct EulerDamping {
  double per_step, frequency_ratio, per_period;
};
EulerDamping implicit_euler_damping(double frequency_rad_per_s, double step_s);

}  // namespace clothbench::truth

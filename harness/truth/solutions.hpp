#pragma once
#include <array>
#include <cmath>
#include <numbers>
#include <span>
#include <vector>

// Exact solutions of simple motions and shapes: formulas, or equations solved numerically; some for the scene's grid.
// Values are in SI units; tensions and loads are per unit width. Callers check the arguments.

namespace clothbench::truth {

/// Points of a strip in its vertical plane, starting at the fixed end; x is horizontal.
using Nodes = std::vector<std::array<double, 2>>;

/// Point at a fraction 0 .. 1 of the strip's length, linear between the nodes.
std::array<double, 2> node_position(const Nodes&, double share);

/// A free body in uniform gravity with damping proportional to its mass: dv/dt = -g - c v (upwards is positive). Every
/// point of a cloth without internal motion follows it, whatever its stiffness.
///   v = v0 e^{-ct} - g (1 - e^{-ct})/c,   z = v0 t p1(ct) - g t^2 p2(ct),
///   p1(x) = (1 - e^{-x})/x,  p2(x) = (x - 1 + e^{-x})/x^2  (1 and 1/2 at x = 0).
/// Source: Newton's second law. Rounding errors only.
struct FreeFall {
  double speed_m_per_s = 0;  ///< upwards
  double gravity_m_per_s2 = 9.81;
  double damping_per_s = 0;
};
double fall_height_m(const FreeFall&, double time_s);

/// Plane pendulum released at rest: theta'' = -(g/l) sin theta, theta from the vertical.
///   T = 4 sqrt(l/g) K(k),  sin(theta/2) = k cd(sqrt(g/l) t, k),  k = sin(amplitude/2)
/// with Jacobi's elliptic function cd. Source: Abramowitz & Stegun 16 and 17. Valid for 0 < amplitude < pi; the
/// rounding error grows with the number of periods.
struct Pendulum {
  double length_m = 1;
  double gravity_m_per_s2 = 9.81;
  double amplitude_rad = 0;
};
double pendulum_period_s(const Pendulum&);
double pendulum_angle_rad(const Pendulum&, double time_s);

/// A straight strip of inextensible links without bending stiffness, fixed at one end and released at rest from the
/// horizontal: the motion of an inextensible strip with nodal masses on the same mesh. Coordinates are the link angles.
/// Tensions T_j follow from |r_j - r_{j-1}| = a, differentiated twice, with c_j = cos(theta_{j+1} - theta_j):
///   T_j (1/m_j + 1/m_{j-1}) - T_{j+1} c_j/m_j - T_{j-1} c_{j-1}/m_{j-1} = a theta_j'^2,
///   a theta_j'' = T_{j+1} sin(theta_{j+1} - theta_j)/m_j + T_{j-1} sin(theta_{j-1} - theta_j)/m_{j-1},
/// where for j = 1 the terms with m_0 are replaced by + g sin(theta_1) and + g cos(theta_1) on the right. Source:
/// Newton's second law with Lagrange multipliers. Integrated by Boost.Odeint (Runge-Kutta-Fehlberg 7(8)).
///
/// A strip released from the horizontal is chaotic after 0.5 s * sqrt(L/1 m * 9.81/g): compare positions only until
/// then. Until then the error of the positions is below 1e-10 L at the default tolerance.
struct SwingingChain {
  int links = 32;
  double length_m = 1;
  double gravity_m_per_s2 = 9.81;
  double end_mass_ratio = 0.5;  ///< mass of the free end row over mass of an inner row: 1/2 for lumped masses
};
/// The links + 1 nodes [m] at `times_s` (ascending, 0 or more), second coordinate upwards. `tolerance`: error per step
/// of angles, and of angular speeds in units of sqrt(g/L).
std::vector<Nodes> swing(const SwingingChain&, std::span<const double> times_s, double tolerance = 1e-13);

/// A strip of springs, T = Y (lambda - 1) per unit rest width, that hangs at rest from its upper edge (s = 0) under its
/// weight and a load F on its lower edge: T(s) = rho g (L - s) + F, displacement u = (rho g/Y)(L s - s^2/2) + F s/Y.
/// Rows of springs whose cells give half of their mass to each adjacent row lie exactly on this curve. Source:
/// equilibrium of a heavy bar. Rounding errors only.
struct HeavyStrip {
  double length_m = 1;
  double areal_density_kg_per_m2 = 0.2;
  double membrane_stiffness_N_per_m = 1000;
  double gravity_m_per_s2 = 9.81;
  double end_load_N_per_m = 0;
};
double hang_displacement_m(const HeavyStrip&, double rest_m);

/// Rest shape of a clamped, horizontal strip of rigid links under its own weight, Gamma = rho g L^3/B: the minimum of
/// potential energy plus bending energy, (B/2a^3)|x_{i-1} - 2 x_i + x_{i+1}|^2 per link (quadratic isometric bending,
/// Bergou et al. 2006), with lumped row masses. The clamp acts on half a cell, so its hinge is twice as stiff. Newton's
/// method follows the branch from zero load, with angles to 1e-13. Converges with order 2 in 1/links to Euler's
/// elastica, theta'' = -Gamma (1 - s) cos(theta). Returns links + 1 nodes divided by the length; second coordinate
/// downwards. Valid for 0 <= Gamma <= 1e4 while no hinge rotates by 90 degrees.
Nodes cantilever_nodes(int links, double own_weight);

/// A straight chain of equal springs with lumped masses (half a cell at each end), without gravity, whose ends are
/// moved along it: the motion of a strip pulled by hands on the same mesh, with engineering strain
///   x_i'' = (c/a)^2 (x_{i+1} - 2 x_i + x_{i-1}),  c = sqrt(Y/rho),  a = L/n.
/// Source: Newton's second law. Integrated as the swinging chain; errors below 1e-10 L by default.
struct PulledChain {
  int links = 32;
  double length_m = 1;
  double areal_density_kg_per_m2 = 0.2;
  double membrane_stiffness_N_per_m = 1000;
};
/// Displacements [m] of all links + 1 nodes at `times_s` (ascending from 0), from rest. The ends have the given
/// displacements at these times and move linearly between them.
std::vector<std::vector<double>> pull(const PulledChain&, std::span<const double> times_s,
                                      std::span<const double> first_m, std::span<const double> last_m,
                                      double tolerance = 1e-13);

/// The same pull in the continuum, as a sum of images (d'Alembert): u_tt = c^2 u_xx, x from the middle, each end moving
/// outwards with v(t) = v0 sin^2(pi t/(2 Tr)) up to t = Tr and v0 after it; the wave from each end adds a strain of
/// v0/c. The ramp must be L/c or longer: after a sudden start a chain overshoots by 25 %. Rounding errors only.
struct PullWave {
  double length_m, wave_speed_m_per_s, hand_speed_m_per_s, ramp_s;

  double hand_displacement_m(double t) const {
    if (t <= 0) return 0;
    if (t >= ramp_s) return hand_speed_m_per_s * (t - 0.5 * ramp_s);
    return 0.5 * hand_speed_m_per_s * (t - ramp_s / std::numbers::pi * std::sin(std::numbers::pi * t / ramp_s));
  }
  double displacement_m(double x, double t) const {
    const double half = length_m / 2, c = wave_speed_m_per_s;
    double sum = 0;
    for (double path = half; path - half <= c * t; path += length_m)
      sum += hand_displacement_m(t - (path - x) / c) - hand_displacement_m(t - (path + x) / c);
    return sum;
  }
};

/// A cloth that lies flat on a plane at `angle` from the horizontal and starts downhill at `speed`, with Coulomb
/// friction: acceleration g (sin - mu cos) until it stops, then rest; from rest it sticks if tan(angle) <= mu. Source:
/// Coulomb 1781. Valid for 0 <= angle < pi/2. Rounding errors only.
struct Incline {
  double angle_rad = 0;
  double friction = 0;
  double speed_m_per_s = 0;
  double gravity_m_per_s2 = 9.81;
};
struct SlideState {
  double distance_m, speed_m_per_s;  ///< downhill, or towards the heavy side
};
SlideState slide_down(const Incline&, double time_s);

/// An inextensible strip without bending stiffness over a fixed horizontal cylinder with Coulomb friction and its own
/// weight, both ends hanging straight down:
///   dT/dphi = mu (T + rho g R sin phi) + rho g R cos phi,  phi = 0 .. pi from the light side.
/// With `turns` = m > 0 the strip has lumped rows, of which m are in contact, at phi = (j - 1/2) pi/m (edges 2 R
/// sin(pi/2m)). Friction cone at each row, with d = pi/m and q = rho g * edge:
///   T+ (cos(d/2) - mu sin(d/2)) = T (cos(d/2) + mu sin(d/2)) + q (cos phi + mu sin phi).
/// It converges to the smooth strip with order 2 in 1/m. Without weight both are Euler's and Eytelwein's T2/T1 = e^{mu
/// pi}. Source: balance of one element. Rounding errors only.
struct Capstan {
  double friction = 0.3;
  double radius_m = 0.05;
  double areal_density_kg_per_m2 = 0.2;
  double gravity_m_per_s2 = 9.81;
  int turns = 0;
};
/// Maximum overhang below the axis that `light_overhang_m` on the other side can balance.
double greatest_overhang_m(const Capstan&, double light_overhang_m);

/// The strip sliding from rest. At speed v, pressure times R is T + rho g R sin phi - rho v^2, and
///   v' [l2 + E l1 + R (E - 1)/mu] = g (l2 - greatest_overhang(l1)) + v^2 (E - 1),   l1, l2 = current overhangs,
/// with E = e^{mu pi}. The inertia is the smooth strip's, whatever `turns`. A strip that does not slip stays at rest.
/// Throws Error for a time at which the light end has reached the axis. Expects light_overhang_m <= heavy_overhang_m.
/// Integrated as above, tolerance 1e-12.
std::vector<SlideState> slide_over(const Capstan&, double light_overhang_m, double heavy_overhang_m,
                                   std::span<const double> times_s);

}  // namespace clothbench::truth

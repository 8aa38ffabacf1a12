#pragma once
#include <span>
#include <vector>

namespace clothbench::truth {

/// An inextensible strip without bending stiffness over a fixed cylinder with Coulomb friction; tensions are per width.
///
/// Without weight, at wrap angle beta, it holds up to T2/T1 = e^{mu beta}. Source: Euler 1769, Eytelwein 1808.
double capstan_ratio(double friction, double wrap_rad);

/// A strip over a horizontal cylinder with both ends hanging straight down (wrap pi) and its own weight:
///   dT/dphi = mu (T + rho g R sin phi) + rho g R cos phi,  phi from the light side, so at slip
///   T2 = e^{mu pi} T1 + (2 mu rho g R/(1 + mu^2)) (1 + e^{mu pi}).
/// Source: derived from the balance of one element. Valid for mu >= 0, R >= 0, T1 >= 0; Error otherwise. Rounding only.
struct HeavyCapstan {
  double friction = 0.3;
  double radius_m = 0.05;
  double areal_density_kg_per_m2 = 0.2;
  double gravity_m_per_s2 = 9.81;
};

/// Greatest tension on the heavy side that `light_tension` still holds, both at the height of the axis.
double greatest_tension_N_per_m(const HeavyCapstan&, double light_tension_N_per_m);

/// Tension at `phi` (0 = light side .. pi) at the onset of slip; normal pressure times R is T + rho g R sin(phi).
double slip_tension_N_per_m(const HeavyCapstan&, double light_tension_N_per_m, double phi_rad);

/// Longest overhang below the axis that `light_overhang_m` on the other side can hold.
double greatest_overhang_m(const HeavyCapstan&, double light_overhang_m);
bool holds(const HeavyCapstan&, double overhang_1_m, double overhang_2_m);

/// The same for a strip of lumped rows, of which m are in contact, at phi = (j - 1/2) pi/m, j = 1 .. m (edges 2 R
/// sin(pi/2m), each of m equal turns; the hanging parts are vertical from the outermost rows). The weight of a row is q
/// = rho g * edge. Friction cone at each row, with d = pi/m:
///   T+ (cos(d/2) - mu sin(d/2)) = T (cos(d/2) + mu sin(d/2)) + q (cos phi + mu sin phi).
/// An overhang l below the axis pulls with rho g (l + R sin(d/2) - edge/2) = rho g l on the outermost row, as the row
/// itself carries half an edge of it. Converges to the smooth strip with order 2 in 1/m. Throws Error as above, or if
/// mu tan(d/2) >= 1.
double polygonal_greatest_overhang_m(const HeavyCapstan&, double light_overhang_m, int turns);

/// The same strip sliding from rest, its ends hanging. At speed v, pressure times R is T + rho g R sin phi - rho v^2
/// and
///   v' [l2 + E l1 + R (E - 1)/mu] = g (l2 - E l1 - C) + v^2 (E - 1),   l1, l2 = overhangs now,
/// with E = e^{mu pi} and C = 2 mu R (1 + E)/(1 + mu^2). Source: derived from the balance of one moving element. With
/// `turns` > 0 the bracket on the right is that of the polygon above, l2 - polygonal_greatest_overhang(l1), so that
/// sliding starts where the polygon slips; the inertia stays smooth. A strip that holds stays static. Throws Error as
/// above, and for a time at which the light end has reached the axis. Integrated by Runge-Kutta-Fehlberg 7(8),
/// tolerance 1e-12.
struct SlidState {
  double time_s, way_m, speed_m_per_s;
};
std::vector<SlidState> slide(const HeavyCapstan&, double overhang_1_m, double overhang_2_m, int turns,
                             std::span<const double> times_s);

}  // namespace clothbench::truth

#pragma once

namespace clothbench::truth {

/// Force law along a strip (per unit rest width), in terms of the stretch lambda:
///   EngineeringSpring        T = Y (lambda - 1)
///   StVenantKirchhoff        T = Y lambda (lambda^2 - 1)/2
///   NeoHookeIncompressible   T = Y (lambda - 1/lambda^2)/3
enum class StretchLaw { EngineeringSpring, StVenantKirchhoff, NeoHookeIncompressible };

/// A strip that hangs at rest from its upper edge (s = 0), under its weight and a load F on its lower edge: T(s) = rho
/// g (L - s) + F. Displacement in closed form: with dT = -rho g ds,
///   u(s) = integral over [0, s] of (lambda - 1) = (1/(rho g)) * integral of (lambda - 1) dT(lambda),
/// for springs u = (rho g/Y)(L s - s^2/2) + F s/Y. For two materials, apply the lower half's weight to the upper as F.
/// Source: equilibrium of a heavy bar; laws as in Holzapfel, Nonlinear Solid Mechanics, ch. 6 (uniaxial stress). Valid
/// for any load >= 0; errors of rounding (1e-13 relative). Throws Error for a value that is not positive (F: negative).
struct HeavyStrip {
  double length_m = 1;
  double areal_density_kg_per_m2 = 0.2;
  double membrane_stiffness_N_per_m = 1000;
  double gravity_m_per_s2 = 9.81;
  double end_load_N_per_m = 0;
  StretchLaw law = StretchLaw::EngineeringSpring;
};

double hang_tension_N_per_m(const HeavyStrip&, double rest_m);
double hang_strain(const HeavyStrip&, double rest_m);  ///< lambda - 1
double hang_displacement_m(const HeavyStrip&, double rest_m);

/// Distribution of the mass over the rows of a strip of n cells.
enum class RowMass {
  Lumped,     ///< half of each cell to either row: end rows have half
  EqualFree,  ///< the whole mass in equal parts on the n free rows
};

/// Displacement of row `row` (0 = held .. cells) of a chain of `cells` springs, EngineeringSpring only. Lumped rows lie
/// exactly on the continuum's curve; with EqualFree the own-weight part at the end is (1 + 1/n) times too great.
double hang_row_displacement_m(const HeavyStrip&, int cells, int row, RowMass);

}  // namespace clothbench::truth

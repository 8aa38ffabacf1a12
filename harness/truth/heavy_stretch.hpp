#pragma once

namespace clothbench::truth {

/// A strip of springs, T = Y (lambda - 1) per unit rest width, that hangs at rest from its upper edge (s = 0), under
/// its weight and a load F on its lower edge: T(s) = rho g (L - s) + F, displacement u = (rho g/Y)(L s - s^2/2) + F
/// s/Y. For two materials, apply the lower half's weight to the upper as F. Source: equilibrium of a heavy bar. Valid
/// for any load >= 0; errors of rounding. Throws Error for a value that is not positive (F: negative).
struct HeavyStrip {
  double length_m = 1;
  double areal_density_kg_per_m2 = 0.2;
  double membrane_stiffness_N_per_m = 1000;
  double gravity_m_per_s2 = 9.81;
  double end_load_N_per_m = 0;
};

double hang_displacement_m(const HeavyStrip&, double rest_m);

/// Displacement of row `row` (0 = held .. cells) of a chain of `cells` springs. Either row of a cell has half of its
/// mass: rows lie exactly on the continuum's curve.
double hang_row_displacement_m(const HeavyStrip&, int cells, int row);

}  // namespace clothbench::truth

#include "truth/heavy_stretch.hpp"

#include <boost/math/tools/roots.hpp>
#include <cmath>

#include "clothbench/error.hpp"
#include "truth/checks.hpp"

namespace clothbench::truth {
namespace {

// All in terms of e = lambda - 1, so that small strains keep their digits.
double force_over_stiffness(StretchLaw law, double e) {
  switch (law) {
    case StretchLaw::EngineeringSpring:
      return e;
    case StretchLaw::StVenantKirchhoff:
      return (1 + e) * e * (2 + e) / 2;
    case StretchLaw::NeoHookeIncompressible:
      return e * (3 + e * (3 + e)) / (3 * (1 + e) * (1 + e));
  }
  throw Error("argument law: unknown stretch law");
}

// Integral of e d(T/Y) from 0 to e.
double displacement_integral(StretchLaw law, double e) {
  switch (law) {
    case StretchLaw::EngineeringSpring:
      return e * e / 2;
    // T/Y = e + 3/2 e^2 + e^3/2, so dT/Y = 1 + 3 e + 3/2 e^2.
    case StretchLaw::StVenantKirchhoff:
      return e * e * (0.5 + e * (1 + e * 3.0 / 8));
    // dT/Y = (1 + 2/lambda^3)/3: e^2/6 + (2/3)(1/2 - 1/lambda + 1/(2 lambda^2)), the bracket being (e/lambda)^2/2.
    case StretchLaw::NeoHookeIncompressible:
      return e * e * (1.0 / 6 + 1.0 / (3 * (1 + e) * (1 + e)));
  }
  throw Error("argument law: unknown stretch law");
}

double strain_under(StretchLaw law, double force) {
  if (law == StretchLaw::EngineeringSpring || force == 0) return force;
  // e = 3 force + 3 is above the root for both laws: T grows at least as e/3 beyond e = 3.
  std::uintmax_t iterations = 200;
  const auto excess = [&](double e) { return force_over_stiffness(law, e) - force; };
  const auto bracket = boost::math::tools::toms748_solve(excess, 0.0, 3 * force + 3, -force, excess(3 * force + 3),
                                                         boost::math::tools::eps_tolerance<double>(52), iterations);
  return 0.5 * (bracket.first + bracket.second);
}

void check(const HeavyStrip& s, double rest_m) {
  positive(s.length_m, "length_m");
  positive(s.areal_density_kg_per_m2, "areal_density_kg_per_m2");
  positive(s.membrane_stiffness_N_per_m, "membrane_stiffness_N_per_m");
  positive(s.gravity_m_per_s2, "gravity_m_per_s2");
  non_negative(s.end_load_N_per_m, "end_load_N_per_m");
  within(rest_m, 0, s.length_m, "rest_m");
}

}  // namespace

double hang_tension_N_per_m(const HeavyStrip& s, double rest) {
  check(s, rest);
  return s.areal_density_kg_per_m2 * s.gravity_m_per_s2 * (s.length_m - rest) + s.end_load_N_per_m;
}

double hang_strain(const HeavyStrip& s, double rest) {
  return strain_under(s.law, hang_tension_N_per_m(s, rest) / s.membrane_stiffness_N_per_m);
}

double hang_displacement_m(const HeavyStrip& s, double rest) {
  check(s, rest);
  const double weight = s.areal_density_kg_per_m2 * s.gravity_m_per_s2;
  if (s.law == StretchLaw::EngineeringSpring)
    return rest * (weight * (s.length_m - 0.5 * rest) + s.end_load_N_per_m) / s.membrane_stiffness_N_per_m;
  const double top = displacement_integral(s.law, hang_strain(s, 0));
  const double here = displacement_integral(s.law, hang_strain(s, rest));
  return (top - here) * s.membrane_stiffness_N_per_m / weight;
}

double hang_row_displacement_m(const HeavyStrip& s, int cells, int row, RowMass masses) {
  check(s, 0);
  at_least(cells, 1, "cells");
  if (row < 0 || row > cells) throw Error("argument row: expected 0 (held) up to the number of cells");
  if (s.law != StretchLaw::EngineeringSpring)
    throw Error("argument law: expected EngineeringSpring for rows of springs");
  const double cell = s.length_m / cells, row_weight = s.areal_density_kg_per_m2 * s.gravity_m_per_s2 * cell;
  const double end_row = masses == RowMass::Lumped ? 0.5 : 1.0;
  double displacement = 0;
  for (int i = 1; i <= row; ++i)
    displacement += cell * (row_weight * (cells - i + end_row) + s.end_load_N_per_m) / s.membrane_stiffness_N_per_m;
  return displacement;
}

}  // namespace clothbench::truth

#include "truth/heavy_stretch.hpp"

#include "clothbench/error.hpp"
#include "truth/checks.hpp"

namespace clothbench::truth {
namespace {

void check(const HeavyStrip& s, double rest_m) {
  positive(s.length_m, "length_m");
  positive(s.areal_density_kg_per_m2, "areal_density_kg_per_m2");
  positive(s.membrane_stiffness_N_per_m, "membrane_stiffness_N_per_m");
  positive(s.gravity_m_per_s2, "gravity_m_per_s2");
  non_negative(s.end_load_N_per_m, "end_load_N_per_m");
  within(rest_m, 0, s.length_m, "rest_m");
}

}  // namespace

double hang_displacement_m(const HeavyStrip& s, double rest) {
  check(s, rest);
  const double weight = s.areal_density_kg_per_m2 * s.gravity_m_per_s2;
  return rest * (weight * (s.length_m - 0.5 * rest) + s.end_load_N_per_m) / s.membrane_stiffness_N_per_m;
}

double hang_row_displacement_m(const HeavyStrip& s, int cells, int row) {
  check(s, 0);
  at_least(cells, 1, "cells");
  if (row < 0 || row > cells) throw Error("argument row: expected 0 (held) up to the number of cells");
  const double cell = s.length_m / cells, row_weight = s.areal_density_kg_per_m2 * s.gravity_m_per_s2 * cell;
  double displacement = 0;
  for (int i = 1; i <= row; ++i)
    displacement += cell * (row_weight * (cells - i + 0.5) + s.end_load_N_per_m) / s.membrane_stiffness_N_per_m;
  return displacement;
}

}  // namespace clothbench::truth

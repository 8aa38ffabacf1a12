#include "runner/stability_theory.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "clothbench/error.hpp"

namespace clothbench {

double highest_frequency_rad_per_s(const Scene& s) {
  const auto& Y = s.material.membrane_stiffness_N_per_m;
  if (!Y) return std::numeric_limits<double>::infinity();
  const double a = s.cloth.du(), b = s.cloth.dv(), rho = s.cloth.areal_density_kg_per_m2;
  if (!s.needs.has(Feature::Shear)) return 2 * std::sqrt(*Y / rho) / std::min(a, b);
  const double diagonal = diagonal_spring_N_per_m(*Y, {a, b}), squared = a * a + b * b;
  const double u = 2 * grid_spring_N_per_m(*Y, {a, b}, true) + 4 * diagonal * a * a / squared,
               v = 2 * grid_spring_N_per_m(*Y, {b, a}, true) + 4 * diagonal * b * b / squared;
  return std::sqrt(2 * std::max(u, v) / (rho * a * b));
}

double theory(const std::string& name, const Scene& s, int substeps) {
  if (name == "explicit-limit") return substeps * 2 / highest_frequency_rad_per_s(s);
  if (name == "float32-stagnation") {
    const Vec3& g = s.gravity_m_per_s2;
    const double h = s.time.dt() / substeps, step_m = std::sqrt(g[0] * g[0] + g[1] * g[1] + g[2] * g[2]) * h * h;
    // ulp(x) = 2^(e - 23) for 2^e <= x < 2^(e + 1): the step is half of it or less from 2^e on.
    return std::exp2(std::ceil(std::log2(2 * step_m)) + 23);
  }
  if (name == "substep-per-cell") return substeps;
  throw Error("theory \"" + name + "\": expected explicit-limit, float32-stagnation or substep-per-cell");
}

std::string theory_label(const std::string& name) {
  if (name == "explicit-limit") return "explicit limit: highest frequency x substep = 2";
  if (name == "float32-stagnation") return "float32: displacement by gravity in a substep is half an ulp";
  if (name == "substep-per-cell") return "one cell a substep";
  return name;
}

}  // namespace clothbench

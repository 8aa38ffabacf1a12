// Other force laws of a hanging strip: springs are one of three that a published table has.
#pragma once
#include <boost/math/tools/roots.hpp>
#include <cmath>

#include "clothbench/error.hpp"
#include "truth/heavy_stretch.hpp"

namespace clothbench::truth {

/// Force along a strip (per unit rest width), in terms of the stretch lambda:
///   EngineeringSpring        T = Y (lambda - 1)
///   StVenantKirchhoff        T = Y lambda (lambda^2 - 1)/2
///   NeoHookeIncompressible   T = Y (lambda - 1/lambda^2)/3
/// Source: Holzapfel, Nonlinear Solid Mechanics, ch. 6 (uniaxial stress).
enum class StretchLaw { EngineeringSpring, StVenantKirchhoff, NeoHookeIncompressible };

// All in terms of e = lambda - 1, so that small strains keep their digits.
inline double force_over_stiffness(StretchLaw law, double e) {
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
inline double displacement_integral(StretchLaw law, double e) {
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

inline double strain_under(StretchLaw law, double force) {
  if (law == StretchLaw::EngineeringSpring || force == 0) return force;
  // e = 3 force + 3 is above the root for both laws: T grows at least as e/3 beyond e = 3.
  std::uintmax_t iterations = 200;
  const auto excess = [&](double e) { return force_over_stiffness(law, e) - force; };
  const auto bracket = boost::math::tools::toms748_solve(excess, 0.0, 3 * force + 3, -force, excess(3 * force + 3),
                                                         boost::math::tools::eps_tolerance<double>(52), iterations);
  return 0.5 * (bracket.first + bracket.second);
}

inline double hang_tension_N_per_m(const HeavyStrip& s, double rest) {
  return s.areal_density_kg_per_m2 * s.gravity_m_per_s2 * (s.length_m - rest) + s.end_load_N_per_m;
}

/// lambda - 1.
inline double hang_strain(const HeavyStrip& s, double rest, StretchLaw law) {
  return strain_under(law, hang_tension_N_per_m(s, rest) / s.membrane_stiffness_N_per_m);
}

/// In closed form: with dT = -rho g ds, u(s) = (1/(rho g)) * integral of (lambda - 1) dT(lambda).
inline double hang_displacement_m(const HeavyStrip& s, double rest, StretchLaw law) {
  const double weight = s.areal_density_kg_per_m2 * s.gravity_m_per_s2;
  const double top = displacement_integral(law, hang_strain(s, 0, law)),
               here = displacement_integral(law, hang_strain(s, rest, law));
  return (top - here) * s.membrane_stiffness_N_per_m / weight;
}

}  // namespace clothbench::truth

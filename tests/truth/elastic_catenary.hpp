#pragma once
#include <array>

namespace clothbench::truth {

/// A strip of Hookean springs (engineering strain, membrane stiffness Y) without bending stiffness, held on both short
/// edges at equal height, span d; w = rho g is the weight per rest area, H [N/m] the horizontal tension:
///   d = H L/Y + (2H/w) asinh(w L/2H),   sag = w L^2/(8Y) + (H/w) (sqrt(1 + (wL/2H)^2) - 1).
/// Source: Irvine, Cable Structures (1981). Unlike the inextensible catenary it may span more than its rest length.
/// Valid for 1e-3 <= d/L <= 3. Relative errors are of rounding, but grow to 1e-15 (Y/(wL))^(2/3) near d = L, where the
/// tension of a stiff strip depends on little else. Throws Error for other arguments.
class ElasticCatenary {
 public:
  ElasticCatenary(double length_m, double span_m, double areal_density_kg_per_m2, double membrane_stiffness_N_per_m,
                  double gravity_m_per_s2);
  double horizontal_tension_N_per_m() const { return tension_; }
  double sag_m() const;
  double strain(double rest_m) const;
  /// x from the left end, z upwards from the ends, of the point at rest length s from the left end.
  std::array<double, 2> position_m(double rest_m) const;

 private:
  double length_, span_, weight_, stiffness_, tension_;
};

}  // namespace clothbench::truth

#pragma once
#include <array>
#include <vector>

namespace clothbench::truth {

/// An inextensible strip of rest length L without bending stiffness, held on both short edges at equal height, at a
/// span d < L: z = a cosh(x/a), 2 a sinh(d/2a) = L. Over the weight per length, the tension is a (horizontal) and a +
/// sag (at the ends), so the shape does not depend on weight or gravity. Source: Bernoulli, Leibniz, Huygens 1691;
/// Irvine, Cable Structures, ch. 1. Valid for 1e-3 <= d/L <= 1 - 1e-6, Error otherwise. The relative error is below
/// 1e-14/(1 - d/L), as the equation for a loses digits when the strip becomes taut.
class Catenary {
 public:
  Catenary(double length_m, double span_m);
  double parameter_m() const { return a_; }  ///< a = horizontal tension over weight per length
  double sag_m() const;
  /// Tensions over the strip's whole weight.
  double horizontal_tension() const { return a_ / length_; }
  /// x from the left end, z upwards from the ends, of the point at rest length s from the left end.
  std::array<double, 2> position_m(double rest_m) const;

 private:
  double length_, span_, a_;
};

/// The same for n straight links with lumped masses (cell rows): link i makes the angle
/// tan(phi_i) = (i - (n-1)/2) (W/n) / H, i = 0 .. n-1, with H from sum of cos(phi_i) = n d/L.
/// Compare a solver with n cells with this one. It converges to the catenary with order 2 in 1/n, but for odd n the
/// lowest link is horizontal and there is no middle node. Source: equilibrium of the nodes. Same range and accuracy as
/// Catenary; n >= 2.
class DiscreteCatenary {
 public:
  DiscreteCatenary(int links, double length_m, double span_m);
  double sag_m() const;                                   ///< of the lowest node
  double horizontal_tension() const { return tension_; }  ///< over the strip's whole weight
  std::vector<std::array<double, 2>> nodes_m() const;     ///< links + 1; x from the left end, z from the ends

 private:
  double tangent(int link) const;
  int links_;
  double length_, tension_;
};

}  // namespace clothbench::truth

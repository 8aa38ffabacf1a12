#pragma once
#include <Eigen/Dense>
#include <array>

#include "truth/chebyshev.hpp"

namespace clothbench::truth {

/// Loads on an inextensible strip of length L and bending rigidity B, clamped at one end. Dimensionless, lengths over
/// L.
struct ElasticaLoad {
  double own_weight = 0;       ///< Gamma = rho g L^3 / B
  double tip_load = 0;         ///< alpha = P L^2 / B, P [N/m] the weight per width at the free end
  double clamp_angle_rad = 0;  ///< of the clamp below the horizontal; -pi/2 points up
};

/// Static shape of the strip, Euler's elastica under its own weight and a dead load at the tip; theta below horizontal:
///   theta'' = -(Gamma (1 - s) + alpha) cos(theta),   theta(0) = clamp angle,   theta'(1) = 0.
/// Limits: y = Gamma/8 + alpha/3 for small loads; tip x = sqrt(2/Gamma), theta'(0) = sqrt(2 Gamma) for great ones.
/// Source: Euler 1744; own weight: Bickley 1934; tip load: Bisshopp & Drucker 1945. For Poisson's ratio other than 0, a
/// narrow strip (which may curl across) and a wide one (which may not) bend differently: B must be that of the strip.
///
/// Solved as an integral equation by Chebyshev collocation and Newton (Eigen, dense), along the stable branch that
/// starts straight at load 0. The degree is doubled until the equation's residual between collocation points is below
/// 1e-10 rad; `residual_rad` returns it. Valid for 0 <= Gamma, alpha <= 1e4 and clamp angles within +-pi/2. Throws
/// Error otherwise, or where the branch ends (a strip that points exactly up, beyond self-buckling: perturb the angle).
class Elastica {
 public:
  explicit Elastica(const ElasticaLoad&);
  double angle_rad(double s) const;
  double curvature(double s) const;                ///< theta'(s), per L
  std::array<double, 2> position(double s) const;  ///< x outwards, y downwards, over L
  double tip_angle_rad() const { return angle_(angle_.size() - 1); }
  /// Angle below the horizontal of the line from clamp to tip; its tangent is the H/W ratio of a drape test.
  double chord_angle_rad() const;
  double residual_rad() const { return residual_; }

 private:
  Chebyshev grid_;
  Eigen::VectorXd angle_, curvature_, x_, y_;
  double residual_ = 0;
};

}  // namespace clothbench::truth

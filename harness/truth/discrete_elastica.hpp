#pragma once
#include <array>
#include <vector>

namespace clothbench::truth {

/// Bending energy per width of two neighbouring links of length a with turning angle d: hinges B d^2/(2a), lines
/// (B/2a^3)|x_{i-1} - 2 x_i + x_{i+1}|^2 = (B/a)(1 - cos d) (quadratic isometric bending, Bergou et al. 2006).
enum class BendingModel { Hinge, Line };

/// Stiffness of the hinge between the clamp and the first free link, relative to an inner hinge. A clamp acts on half a
/// cell, so it is 2; with 1 (only two vertex rows held) a cantilever converges with order 1 only.
enum class ClampHinge { FullCell = 1, HalfCell = 2 };

struct DiscreteElasticaLoad {
  int links = 32;         ///< free ones
  double own_weight = 0;  ///< Gamma = rho g L^3/B; lumped row masses, half at the free end
  double tip_load = 0;    ///< alpha = P L^2/B, on the end row
  BendingModel model = BendingModel::Hinge;
  ClampHinge clamp = ClampHinge::HalfCell;
};

/// The minimum of bending and potential energy of a clamped (horizontal) chain of rigid links: the limit to which a
/// solver of the same resolution and bending model should converge. Source: stationary energy; solved by Newton with a
/// tridiagonal matrix along the branch from no load. Converges to Elastica with order 2 in 1/links with
/// ClampHinge::HalfCell, 1 with FullCell. Angles to 1e-13. Throws Error for loads outside [0, 1e4], links < 1, or if
/// Newton fails (Line hinges that turn by more than 90 degrees).
class DiscreteElastica {
 public:
  explicit DiscreteElastica(const DiscreteElasticaLoad&);
  const std::vector<double>& angles_rad() const { return angle_; }  ///< per link, below the horizontal
  std::vector<std::array<double, 2>> nodes() const;                 ///< links + 1; x outwards, y downwards, over L
  std::array<double, 2> tip() const { return nodes().back(); }

 private:
  std::vector<double> angle_;
};

}  // namespace clothbench::truth

#pragma once
#include <Eigen/Dense>

namespace clothbench::truth {

/// Polynomials on [0, 1], given by their values at the degree + 1 Chebyshev-Lobatto points in ascending order, ends
/// included. Source: Trefethen, Spectral Methods in MATLAB, ch. 6 and 12; barycentric formula: Berrut & Trefethen, SIAM
/// Review 2004.
class Chebyshev {
 public:
  explicit Chebyshev(int degree);  ///< degree >= 2
  const Eigen::VectorXd& points() const { return points_; }
  /// Row j: weights that integrate from 0 to point j. Exact for polynomials up to the degree; well conditioned, unlike
  /// differentiation, which is why boundary-value problems here are solved in integral form.
  const Eigen::MatrixXd& integral_from_0() const { return integral_; }
  Eigen::MatrixXd integral_to_1() const;  ///< row j: from point j to 1
  double interpolate(const Eigen::VectorXd& values, double s) const;

 private:
  Eigen::VectorXd points_;
  Eigen::MatrixXd integral_;
};

}  // namespace clothbench::truth

#include "truth/chebyshev.hpp"

#include <cmath>
#include <numbers>

#include "truth/checks.hpp"

namespace clothbench::truth {

Chebyshev::Chebyshev(int degree) {
  const int n = at_least(degree, 2, "degree");
  const auto half_turns = [n](int k) { return std::numbers::pi * (k % (2 * n)) / n; };
  points_.resize(n + 1);
  // T_k at the points x_j = -cos(j pi/n), s_j = (1 + x_j)/2: cos(k (n - j) pi/n).
  Eigen::MatrixXd polynomial(n + 1, n + 2), coefficient(n + 2, n + 1);
  for (int j = 0; j <= n; ++j) {
    const double s = std::sin(half_turns(j) / 2);
    points_(j) = s * s;
    for (int k = 0; k <= n + 1; ++k) polynomial(j, k) = std::cos(half_turns(k * (n - j)));
  }
  coefficient.setZero();
  for (int k = 0; k <= n; ++k)
    for (int j = 0; j <= n; ++j)
      coefficient(k, j) = 2.0 / n * polynomial(j, k) / ((k % n == 0 ? 2 : 1) * (j % n == 0 ? 2 : 1));
  // Integral of T_k over x: T_{k+1}/(2(k+1)) - T_{k-1}/(2(k-1)); T_0 gives T_1. Half of it in s; 0 at s = 0.
  Eigen::MatrixXd integral = Eigen::MatrixXd::Zero(n + 2, n + 1);
  for (int k = 1; k <= n + 1; ++k) {
    integral.row(k) += coefficient.row(k - 1) / (k == 1 ? 1.0 : 2.0 * k);
    if (k + 1 <= n) integral.row(k) -= coefficient.row(k + 1) / (2.0 * k);
    integral.row(k) *= 0.5;
    integral.row(0) -= (k % 2 ? -1 : 1) * integral.row(k);
  }
  integral_ = polynomial * integral;
  integral_.row(0).setZero();
}

Eigen::MatrixXd Chebyshev::integral_to_1() const {
  return (-integral_).rowwise() + integral_.row(integral_.rows() - 1);
}

double Chebyshev::interpolate(const Eigen::VectorXd& values, double s) const {
  const Eigen::Index last = points_.size() - 1;
  double above = 0, below = 0;
  for (Eigen::Index j = 0; j <= last; ++j) {
    if (s == points_(j)) return values(j);
    const double weight = (j % 2 ? -1 : 1) * (j == 0 || j == last ? 0.5 : 1) / (s - points_(j));
    above += weight * values(j);
    below += weight;
  }
  return above / below;
}

}  // namespace clothbench::truth

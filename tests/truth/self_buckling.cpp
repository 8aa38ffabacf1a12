#include "self_buckling.hpp"

#include <Eigen/Dense>
#include <boost/math/special_functions/bessel.hpp>

#include "truth/checks.hpp"

namespace clothbench::truth {

double self_buckling_own_weight() {
  const double zero = boost::math::cyl_bessel_j_zero(-1.0 / 3, 1);
  return 2.25 * zero * zero;
}

double discrete_self_buckling_own_weight(int links, ClampHinge clamp) {
  const double n = at_least(links, 1, "links");
  Eigen::MatrixXd bending = Eigen::MatrixXd::Zero(links, links);
  Eigen::VectorXd weight(links);
  for (int i = 0; i < links; ++i) {
    const double stiffness = (i == 0 && clamp == ClampHinge::HalfCell ? 2 : 1) * n;
    bending(i, i) += stiffness;
    weight(i) = (1 - (i + 0.5) / n) / n;
    if (i == 0) continue;
    bending(i - 1, i - 1) += stiffness;
    bending(i, i - 1) -= stiffness;
    bending(i - 1, i) -= stiffness;
  }
  const Eigen::VectorXd scale = weight.cwiseSqrt().cwiseInverse();
  const Eigen::MatrixXd scaled = scale.asDiagonal() * bending * scale.asDiagonal();
  return Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd>(scaled, Eigen::EigenvaluesOnly).eigenvalues()(0);
}

}  // namespace clothbench::truth

#include "truth/elastica.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <optional>

#include "clothbench/error.hpp"
#include "truth/checks.hpp"

namespace clothbench::truth {
namespace {

constexpr int kFirstDegree = 48, kLastDegree = 768;
constexpr double kGoodResidual_rad = 1e-10;

// theta = clamp - A f(theta), f = -(Gamma (1 - s) + alpha) cos(theta), A = (integral from 0) (integral to 1).
class Problem {
 public:
  Problem(const Chebyshev& grid, const ElasticaLoad& load)
      : clamp_(load.clamp_angle_rad),
        pull_(load.own_weight * (1 - grid.points().array()) + load.tip_load),
        inverse_(grid.integral_from_0() * grid.integral_to_1()) {}

  Eigen::VectorXd residual(const Eigen::VectorXd& angle, double share) const {
    return (angle - inverse_ * (share * pull_ * angle.array().cos()).matrix()).array() - clamp_;
  }

  /// Newton from `angle` with `share` of the load; nothing if it runs away or doesn't settle.
  std::optional<Eigen::VectorXd> solve(Eigen::VectorXd angle, double share) const {
    double last = 1;
    for (int i = 0; i < 30; ++i) {
      const Eigen::VectorXd slope = share * pull_ * angle.array().sin();
      Eigen::MatrixXd matrix = inverse_ * slope.asDiagonal();
      matrix.diagonal().array() += 1;
      const Eigen::PartialPivLU<Eigen::MatrixXd> factors(matrix);
      // One negative eigenvalue of the second variation: an unstable branch, beyond a bifurcation.
      if (!(factors.determinant() > 0)) return std::nullopt;
      const Eigen::VectorXd change = factors.solve(residual(angle, share));
      const double size = change.lpNorm<Eigen::Infinity>();
      if (!(size < 0.5)) return std::nullopt;  // further would be another branch
      angle -= change;
      if (size < 1e-14 || (size < 1e-10 && size >= 0.5 * last)) return angle;
      last = size;
    }
    return std::nullopt;
  }

  /// Follows the branch from no load to the whole.
  Eigen::VectorXd follow() const {
    Eigen::VectorXd angle = Eigen::VectorXd::Constant(pull_.size(), clamp_);
    const double whole = pull_.maxCoeff();
    double share = 0, step = std::min(1.0, 2 / std::max(whole, 1e-300));
    while (share < 1) {
      const double next = std::min(1.0, share + step);
      if (auto solution = solve(angle, next)) {
        angle = std::move(*solution);
        share = next;
        step *= 1.5;
      } else if ((step *= 0.5) < 1e-9) {
        throw Error("elastica: no stable equilibrium found beyond " + std::to_string(share) + " of the load");
      }
    }
    return angle;
  }

 private:
  double clamp_;
  Eigen::ArrayXd pull_;
  Eigen::MatrixXd inverse_;
};

}  // namespace

Elastica::Elastica(const ElasticaLoad& load) : grid_(kFirstDegree) {
  within(load.own_weight, 0, 1e4, "own_weight");
  within(load.tip_load, 0, 1e4, "tip_load");
  within(load.clamp_angle_rad, -std::numbers::pi / 2, std::numbers::pi / 2, "clamp_angle_rad");
  angle_ = Problem(grid_, load).follow();
  for (int degree = 2 * kFirstDegree;; degree *= 2) {
    if (degree > kLastDegree)
      throw Error("elastica: residual " + std::to_string(residual_) + " rad at the highest degree");
    const Chebyshev fine(degree);
    Eigen::VectorXd angle(degree + 1);
    for (Eigen::Index j = 0; j <= degree; ++j) angle(j) = grid_.interpolate(angle_, fine.points()(j));
    const Problem problem(fine, load);
    residual_ = problem.residual(angle, 1).lpNorm<Eigen::Infinity>();
    auto solution = problem.solve(angle, 1);
    if (!solution) throw Error("elastica: Newton's method failed at degree " + std::to_string(degree));
    grid_ = fine;
    angle_ = std::move(*solution);
    if (residual_ <= kGoodResidual_rad) break;
  }
  const Eigen::VectorXd pull = (load.own_weight * (1 - grid_.points().array()) + load.tip_load) * angle_.array().cos();
  curvature_ = grid_.integral_to_1() * pull;
  x_ = grid_.integral_from_0() * angle_.array().cos().matrix();
  y_ = grid_.integral_from_0() * angle_.array().sin().matrix();
}

double Elastica::angle_rad(double s) const { return grid_.interpolate(angle_, within(s, 0, 1, "s")); }

double Elastica::curvature(double s) const { return grid_.interpolate(curvature_, within(s, 0, 1, "s")); }

std::array<double, 2> Elastica::position(double s) const {
  within(s, 0, 1, "s");
  return {grid_.interpolate(x_, s), grid_.interpolate(y_, s)};
}

double Elastica::chord_angle_rad() const {
  const auto tip = position(1);
  return std::atan2(tip[1], tip[0]);
}

}  // namespace clothbench::truth

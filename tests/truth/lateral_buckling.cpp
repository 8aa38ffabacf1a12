#include "lateral_buckling.hpp"

#include <algorithm>
#include <array>
#include <boost/math/interpolators/makima.hpp>
#include <boost/math/special_functions/bessel.hpp>
#include <cmath>
#include <vector>

#include "clothbench/error.hpp"
#include "lateral_buckling_table.hpp"
#include "truth/checks.hpp"

namespace clothbench::truth {
namespace {

/// A ratio to the narrow limit, its uncertainty, and the same by a method one degree lower.
struct Estimate {
  double value, uncertainty, lower_degree;
};

using Rows = std::span<const LateralBucklingRow>;

/// Rows of one Poisson's ratio as ratios over w/L, from (0, 1); optionally over those of another ratio at the same
/// widths.
Estimate along_width(Rows rows, double nu, double width, double over_nu = -1) {
  const double narrow = narrow_lateral_buckling(nu);
  std::vector<double> x{0}, y{1}, uncertainty{0};
  for (const auto& row : rows) {
    if (row.poisson_ratio != nu) continue;
    double base = 1, error = 0;
    if (over_nu >= 0) {
      const Estimate other = along_width(rows, over_nu, row.width_over_length);
      base = other.value;
      error = other.uncertainty / base;
    }
    x.push_back(row.width_over_length);
    y.push_back(row.own_weight / narrow / base);
    uncertainty.push_back(y.back() * (row.uncertainty / row.own_weight + error));
  }
  if (x.size() < 4) throw Error("argument rows: expected at least 3 for each Poisson's ratio");
  const auto above =
      std::max<std::size_t>(1, static_cast<std::size_t>(std::lower_bound(x.begin(), x.end(), width) - x.begin()));
  const double share = (width - x[above - 1]) / (x[above] - x[above - 1]);
  const auto line = [&](const std::vector<double>& v) { return v[above - 1] + share * (v[above] - v[above - 1]); };
  Estimate out{0, line(uncertainty), line(y)};
  boost::math::interpolators::makima cubic(std::move(x), std::move(y));
  out.value = cubic(width);
  out.uncertainty += 2 * std::abs(out.value - out.lower_degree);
  return out;
}

/// Lagrange's polynomial through the points, and the one without the point farthest from `x`.
template <std::size_t N>
Estimate polynomial(const std::array<double, N>& x, const std::array<Estimate, N>& y, double at) {
  const auto far = static_cast<std::size_t>(
      std::max_element(x.begin(), x.end(), [&](double a, double b) { return std::abs(a - at) < std::abs(b - at); }) -
      x.begin());
  const auto evaluate = [&](std::size_t left_out, auto member, bool absolute) {
    double sum = 0;
    for (std::size_t i = 0; i < N; ++i) {
      if (i == left_out) continue;
      double weight = 1;
      for (std::size_t j = 0; j < N; ++j)
        if (j != i && j != left_out) weight *= (at - x[j]) / (x[i] - x[j]);
      sum += (absolute ? std::abs(weight) : weight) * y[i].*member;
    }
    return sum;
  };
  Estimate out{evaluate(N, &Estimate::value, false), evaluate(N, &Estimate::uncertainty, true),
               evaluate(far, &Estimate::value, false)};
  out.uncertainty += std::abs(out.value - out.lower_degree);
  return out;
}

}  // namespace

double michell_prandtl_constant() { return 6 * boost::math::cyl_bessel_j_zero(-1.0 / 6, 1); }

double narrow_lateral_buckling(double nu) {
  between(nu, -1, std::nextafter(0.5, 1), "poisson_ratio");
  return michell_prandtl_constant() * (1 - nu) * std::sqrt(2 * (1 + nu));
}

std::span<const LateralBucklingRow> lateral_buckling_table() { return kLateralBucklingTable; }

SourcedValue lateral_buckling(double width, double nu, Rows rows) {
  constexpr double kThird = 1.0 / 3;
  within(nu, 0, 0.5, "poisson_ratio");
  within(width, 0, nu <= kThird ? 2 : 1, "width_over_length (at this Poisson's ratio)");
  const double narrow = narrow_lateral_buckling(nu);
  if (width == 0) return {narrow, 0, false, "formula of Michell and Prandtl for a narrow sheet"};
  Estimate ratio;
  if (nu <= kThird) {
    ratio = polynomial<3>(
        {0, 0.3, kThird},
        {along_width(rows, 0, width), along_width(rows, 0.3, width), along_width(rows, kThird, width)}, nu);
  } else {
    // Few rows beyond 1/3: interpolate how they differ from those at 1/3.
    const Estimate third = along_width(rows, kThird, width);
    const Estimate change = polynomial<3>(
        {kThird, 0.35, 0.5},
        {Estimate{1, 0, 1}, along_width(rows, 0.35, width, kThird), along_width(rows, 0.5, width, kThird)}, nu);
    ratio.value = third.value * change.value;
    ratio.uncertainty = third.uncertainty * change.value + third.value * change.uncertainty;
  }
  return {narrow * ratio.value, narrow * ratio.uncertainty, true,
          "interpolated in a table of finite-element solutions of the buckling plate"};
}

}  // namespace clothbench::truth

#include "lateral_buckling.hpp"

#include <gtest/gtest.h>

#include <Eigen/Eigenvalues>
#include <cmath>
#include <vector>

#include "clothbench/error.hpp"
#include "truth/chebyshev.hpp"

namespace clothbench::truth {
namespace {

TEST(LateralBuckling, NarrowLimit) {
  EXPECT_NEAR(michell_prandtl_constant(), 12.853763321383317, 1e-12);  // Michell 1899, Prandtl 1899: 12.85
  const double printed[][2] = {
      {0, 18.177966}, {0.3, 14.508249}, {1.0 / 3, 13.993405}, {0.35, 13.728577}, {0.5, 11.131686}};
  for (const auto& [nu, value] : printed) EXPECT_NEAR(narrow_lateral_buckling(nu), value, 5e-7);
  // 12 (1 - nu^2) 12.853764/sqrt(72 (1 + nu)), the same for an isotropic sheet of thickness h.
  EXPECT_NEAR(narrow_lateral_buckling(0.2), 12 * (1 - 0.04) * 12.853763321383317 / std::sqrt(72 * 1.2), 1e-12);
  // Twist: phi'' + (k^2/4) (1 - s)^4 phi = 0, phi(0) = 0, phi'(1) = 0; 4/k^2 is the greatest eigenvalue.
  const Chebyshev grid(40);
  const Eigen::VectorXd weight = (1 - grid.points().array()).pow(4);
  const Eigen::MatrixXd matrix = grid.integral_from_0() * grid.integral_to_1() * weight.asDiagonal();
  EXPECT_NEAR(2 / std::sqrt(Eigen::EigenSolver<Eigen::MatrixXd>(matrix).eigenvalues().real().maxCoeff()),
              michell_prandtl_constant(), 1e-10);
}

TEST(LateralBuckling, PassesThroughItsRowsAndSaysThatItInterpolates) {
  ASSERT_EQ(lateral_buckling_table().size(), 36u);
  for (const auto& row : lateral_buckling_table()) {
    const SourcedValue v = lateral_buckling(row.width_over_length, row.poisson_ratio);
    EXPECT_NEAR(v.value, row.own_weight, 1e-9);
    EXPECT_GE(v.uncertainty, row.uncertainty * (1 - 1e-9));
    EXPECT_LE(v.uncertainty, 3 * row.uncertainty);
    EXPECT_TRUE(v.interpolated);
    EXPECT_NE(v.basis.find("interpolated"), std::string::npos);
  }
  const SourcedValue narrow = lateral_buckling(0, 0.2);
  EXPECT_FALSE(narrow.interpolated);
  EXPECT_EQ(narrow.value, narrow_lateral_buckling(0.2));
  EXPECT_EQ(narrow.uncertainty, 0);
}

TEST(LateralBuckling, FindsRowsThatWereLeftOutWithinItsUncertainty) {
  for (const double left_out : {0.05, 0.1, 0.2, 0.3, 0.5, 0.75, 1.0, 1.5}) {
    std::vector<LateralBucklingRow> rest;
    for (const auto& row : lateral_buckling_table())
      if (row.width_over_length != left_out || row.poisson_ratio > 0.34) rest.push_back(row);
    for (const auto& row : lateral_buckling_table()) {
      if (row.width_over_length != left_out || row.poisson_ratio > 0.34) continue;
      const SourcedValue v = lateral_buckling(left_out, row.poisson_ratio, rest);
      EXPECT_NEAR(v.value, row.own_weight, v.uncertainty + row.uncertainty) << left_out << ' ' << row.poisson_ratio;
    }
  }
}

TEST(LateralBuckling, IsSmooth) {
  for (const double nu : {0.0, 0.15, 0.3, 1.0 / 3, 0.4, 0.5})
    for (double w = 0.05; w <= 0.95; w += 0.05) {
      const SourcedValue a = lateral_buckling(w - 0.01, nu), b = lateral_buckling(w, nu),
                         c = lateral_buckling(w + 0.01, nu);
      EXPECT_GT(c.value, b.value - 1e-12) << nu << ' ' << w;
      EXPECT_NEAR(a.value - 2 * b.value + c.value, 0, 0.02) << nu << ' ' << w;
      EXPECT_LT(b.uncertainty / b.value, 0.05) << nu << ' ' << w;
    }
  // Both sides of nu = 1/3 meet.
  EXPECT_NEAR(lateral_buckling(0.4, 1.0 / 3).value, lateral_buckling(0.4, 1.0 / 3 + 1e-9).value, 1e-6);
}

TEST(LateralBuckling, RefusesTooFewRows) {
  EXPECT_THROW(lateral_buckling(0.5, 0.2, lateral_buckling_table().first(12)), Error);
}

}  // namespace
}  // namespace clothbench::truth

#include <Eigen/Eigenvalues>
#include <map>
#include <numbers>
#include <optional>

#include "clothbench/error.hpp"
#include "printed_table.hpp"
#include "self_buckling.hpp"
#include "truth/discrete_elastica.hpp"
#include "truth/elastica.hpp"

namespace clothbench::truth {
namespace {

/// Gamma that Peirce's formula gives for a chord angle c, 8 tan(c)/cos(c/2), i.e. B = rho g L^3 cos(c/2)/(8 tan c). It
/// is an approximation: at 41.5 degrees its B is 5.75 % above the elastica's. Source: Peirce, J. Textile Inst. 21
/// (1930) T377.
double peirce_own_weight(double chord) { return 8 * std::tan(chord) / std::cos(chord / 2); }

TEST(Chebyshev, IntegratesAndInterpolates) {
  const Chebyshev grid(24);
  const Eigen::VectorXd values = (3 * grid.points().array()).sin();
  const Eigen::VectorXd up = grid.integral_from_0() * values, down = grid.integral_to_1() * values;
  for (Eigen::Index j = 0; j < values.size(); ++j) {
    EXPECT_NEAR(up(j), (1 - std::cos(3 * grid.points()(j))) / 3, 1e-15);
    EXPECT_NEAR(down(j), (std::cos(3 * grid.points()(j)) - std::cos(3)) / 3, 1e-15);
  }
  EXPECT_NEAR(grid.interpolate(values, 0.3217), std::sin(3 * 0.3217), 1e-14);
  EXPECT_EQ(grid.points()(0), 0);
  EXPECT_EQ(grid.points()(24), 1);
}

TEST(Elastica, PublishedRowsOfTheHeavyStrip) {
  const PrintedTable table("elastica.csv");
  for (const auto& row : table.rows()) {
    const double gamma = row.at("Gamma");
    const Elastica e({gamma, 0, 0});
    const auto tip = e.position(1);
    EXPECT_LE(e.residual_rad(), 1e-10) << gamma;
    table.expect(e.tip_angle_rad() / kDegree, row.at("tip_angle_deg"), row_text(row));
    table.expect(tip[0], row.at("x_tip"), row_text(row));
    table.expect(tip[1], row.at("y_tip"), row_text(row));
    table.expect(tip[1] / tip[0], row.at("H_over_W"), row_text(row));
    table.expect(e.chord_angle_rad() / kDegree, row.at("chord_angle_deg"), row_text(row));
    table.expect(e.curvature(0), row.at("clamp_curvature_L"), row_text(row));
    const double peirce = peirce_own_weight(e.chord_angle_rad());
    table.expect(peirce, row.at("Gamma_from_Peirce"), row_text(row));
    table.expect(gamma / peirce, row.at("Peirce_B_over_true_B"), row_text(row));
  }
}

TEST(Elastica, PublishedShapes) {
  const PrintedTable table("elastica_shapes.csv");
  double gamma = -1;
  std::optional<Elastica> e;
  for (const auto& row : table.rows()) {
    if (row.at("Gamma") != gamma) e.emplace(ElasticaLoad{gamma = row.at("Gamma"), 0, 0});
    table.expect(e->angle_rad(row.at("s")), row.at("theta_rad"), row_text(row));
  }
}

TEST(Elastica, PublishedRowsOfTheTipLoad) {
  const PrintedTable table("tip_load_elastica.csv");
  for (const auto& row : table.rows()) {
    const Elastica e({0, row.at("alpha"), 0});
    table.expect(e.tip_angle_rad() / kDegree, row.at("tip_angle_deg"), row_text(row));
    table.expect(e.position(1)[0], row.at("x_tip"), row_text(row));
    table.expect(e.position(1)[1], row.at("y_tip"), row_text(row));
  }
  // Bisshopp & Drucker 1945, as printed there.
  EXPECT_NEAR(Elastica({0, 1, 0}).position(1)[1], 0.3017, 5e-5);
  EXPECT_NEAR(Elastica({0, 10, 0}).position(1)[1], 0.8106, 5e-5);
}

TEST(Elastica, Limits) {
  EXPECT_NEAR(Elastica({1e-6, 0, 0}).position(1)[1], 1e-6 / 8, 1e-17);
  EXPECT_NEAR(Elastica({0, 1e-6, 0}).position(1)[1], 1e-6 / 3, 1e-17);
  EXPECT_NEAR(Elastica({3e-6, 2e-6, 0}).position(1)[1], 3e-6 / 8 + 2e-6 / 3, 1e-16);
  const Elastica limp({1e4, 0, 0});
  EXPECT_NEAR(limp.position(1)[0] / std::sqrt(2e-4), 1, 0.01);
  EXPECT_NEAR(limp.curvature(0) / std::sqrt(2e4), 1, 0.01);
  EXPECT_NEAR(Elastica({0, 0, 0.4}).position(0.5)[1], 0.5 * std::sin(0.4), 1e-15);
  // First integral of the tip-loaded one: theta'^2/2 + alpha sin(theta) is constant.
  const Elastica tip({0, 7, -0.5});
  for (const double s : {0.0, 0.3, 0.8})
    EXPECT_NEAR(0.5 * std::pow(tip.curvature(s), 2) + 7 * std::sin(tip.angle_rad(s)), 7 * std::sin(tip.tip_angle_rad()),
                1e-11);
  // At 41.5 degrees Peirce's rigidity is 5.75 % high (Gamma = 8.0042).
  const Elastica flexometer({8.0042, 0, 0});
  EXPECT_NEAR(flexometer.chord_angle_rad() / kDegree, 41.5, 2e-4);
  EXPECT_NEAR(8.0042 / peirce_own_weight(flexometer.chord_angle_rad()), 1.0575, 5e-5);
}

TEST(Elastica, CurvatureAndPositionBelongToTheAngle) {
  const Elastica e({300, 5, 0.3});
  const double h = 1e-5;
  for (const double s : {0.01, 0.2, 0.7}) {
    const auto p = e.position(s - h), q = e.position(s + h);
    EXPECT_NEAR((q[0] - p[0]) / (2 * h), std::cos(e.angle_rad(s)), 1e-6);
    EXPECT_NEAR((q[1] - p[1]) / (2 * h), std::sin(e.angle_rad(s)), 1e-6);
    EXPECT_NEAR(e.curvature(s), (e.angle_rad(s + h) - e.angle_rad(s - h)) / (2 * h), 1e-5);
  }
}

TEST(DiscreteElastica, PublishedRows) {
  const PrintedTable table("discrete_elastica.csv");
  std::map<double, std::array<double, 2>> smooth;  // as printed: the errors were taken from those
  const PrintedTable elastica("elastica.csv");
  for (const auto& row : elastica.rows()) smooth[row.at("Gamma")] = {row.at("x_tip"), row.at("y_tip")};
  for (const auto& row : table.rows()) {
    const double gamma = row.at("Gamma");
    const auto clamp = row.at("half_cell") == 1 ? ClampHinge::HalfCell : ClampHinge::FullCell;
    const auto tip = DiscreteElastica({static_cast<int>(row.at("links")), gamma, 0, BendingModel::Hinge, clamp}).tip();
    table.expect(tip[0], row.at("x_tip"), row_text(row));
    table.expect(tip[1], row.at("y_tip"), row_text(row));
    table.expect(std::hypot(tip[0] - smooth.at(gamma)[0], tip[1] - smooth.at(gamma)[1]), row.at("tip_error"),
                 row_text(row), 1e-13);
  }
}

TEST(DiscreteElastica, OrdersOfTheClamps) {
  const auto exact = Elastica({10, 3, 0}).position(1);
  const auto order = [&](BendingModel model, ClampHinge clamp) {
    const auto error = [&](int n) {
      const auto tip = DiscreteElastica({n, 10, 3, model, clamp}).tip();
      return std::hypot(tip[0] - exact[0], tip[1] - exact[1]);
    };
    return std::log2(error(64) / error(128));
  };
  for (const auto model : {BendingModel::Hinge, BendingModel::Line}) {
    EXPECT_NEAR(order(model, ClampHinge::HalfCell), 2, 0.05);
    EXPECT_NEAR(order(model, ClampHinge::FullCell), 1, 0.05);
  }
}

TEST(DiscreteElastica, OneLinkBalancesItsHinge) {
  // 2 theta = (Gamma/2 + alpha) cos(theta), and sin(theta) for lines.
  const double hinge = DiscreteElastica({1, 3, 1, BendingModel::Hinge, ClampHinge::HalfCell}).angles_rad()[0];
  EXPECT_NEAR(2 * hinge, 2.5 * std::cos(hinge), 1e-14);
  const double line = DiscreteElastica({1, 3, 1, BendingModel::Line, ClampHinge::HalfCell}).angles_rad()[0];
  EXPECT_NEAR(std::tan(line), 1.25, 1e-13);
}

TEST(SelfBuckling, PublishedValueAndTheBoundaryValueProblem) {
  EXPECT_NEAR(self_buckling_own_weight(), 7.837347438943483, 1e-13);  // Greenhill 1881: 7.8373
  // theta = Gamma A ((1 - s) theta) on the collocation grid: 1/Gamma is the greatest eigenvalue.
  const Chebyshev grid(32);
  const Eigen::VectorXd weight = 1 - grid.points().array();
  const Eigen::MatrixXd matrix = grid.integral_from_0() * grid.integral_to_1() * weight.asDiagonal();
  EXPECT_NEAR(1 / Eigen::EigenSolver<Eigen::MatrixXd>(matrix).eigenvalues().real().maxCoeff(),
              self_buckling_own_weight(), 1e-11);
}

TEST(SelfBuckling, ChainIsOfOrderTwoWithHalfAClampHinge) {
  const auto error = [](int n, ClampHinge c) {
    return discrete_self_buckling_own_weight(n, c) - self_buckling_own_weight();
  };
  EXPECT_NEAR(std::log2(error(32, ClampHinge::HalfCell) / error(64, ClampHinge::HalfCell)), 2, 0.05);
  EXPECT_NEAR(std::log2(error(32, ClampHinge::FullCell) / error(64, ClampHinge::FullCell)), 1, 0.1);
}

TEST(SelfBuckling, ALeaningStripTakesOffAtTheCriticalWeight) {
  const auto tip = [](double share) {
    return Elastica({share * self_buckling_own_weight(), 0, -std::numbers::pi / 2 + 1e-3}).position(1)[0];
  };
  EXPECT_LT(tip(0.9), 0.02);
  EXPECT_GT(tip(1.1), 0.3);
  EXPECT_NEAR(Elastica({7.8, 0, -std::numbers::pi / 2}).position(1)[1], -1, 1e-12);
  EXPECT_THROW(Elastica({7.9, 0, -std::numbers::pi / 2}), Error);
}

}  // namespace
}  // namespace clothbench::truth

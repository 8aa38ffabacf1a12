#include "truth/catenary.hpp"

#include "elastic_catenary.hpp"
#include "printed_table.hpp"

namespace clothbench::truth {
namespace {

TEST(Catenary, PublishedRows) {
  const PrintedTable table("catenary.csv");
  for (const auto& row : table.rows()) {
    const double length = 1.7;
    const Catenary c(length, row.at("span") * length);
    table.expect(c.parameter_m() / length, row.at("a"), row_text(row));
    table.expect(c.sag_m() / length, row.at("sag"), row_text(row));
    table.expect(c.horizontal_tension(), row.at("H"), row_text(row));
    // Over the weight per length, tensions are a, and a and L/2 at right angles.
    table.expect(std::atan2(length / 2, c.parameter_m()) / kDegree, row.at("end_angle_deg"), row_text(row));
    table.expect(std::hypot(c.horizontal_tension(), 0.5), row.at("Tmax"), row_text(row));
    for (const int n : {8, 16, 31, 32, 63, 64, 127})
      table.expect(DiscreteCatenary(n, length, row.at("span") * length).sag_m() / length,
                   row.at("sag_discrete_n" + std::to_string(n)), row_text(row));
  }
}

TEST(Catenary, ShapeIsItsCurve) {
  for (const double span : {0.002, 0.3, 1.2, 1.69, 1.699998}) {
    const Catenary c(1.7, span);
    const double a = c.parameter_m(), tolerance = 1e-14 / (1 - span / 1.7) + 1e-14;
    EXPECT_NEAR(c.position_m(0)[0], 0, tolerance);
    EXPECT_NEAR(c.position_m(1.7)[0], span, tolerance);
    EXPECT_NEAR(c.position_m(0.85)[1], -c.sag_m(), tolerance);
    const double middle = c.position_m(0.85)[1];
    for (const double s : {0.1, 0.6, 1.5}) {
      const auto p = c.position_m(s);
      const double shape = std::sinh((p[0] - span / 2) / (2 * a));
      EXPECT_NEAR(p[1] - middle, 2 * a * shape * shape, 1e-10) << span;
    }
  }
}

TEST(Catenary, ChainOfTwoLinksIsATriangle) {
  EXPECT_NEAR(DiscreteCatenary(2, 1, 0.6).sag_m(), 0.4, 1e-14);
  const auto nodes = DiscreteCatenary(17, 2, 1.3).nodes_m();
  EXPECT_NEAR(nodes.back()[0], 1.3, 1e-14);
  EXPECT_NEAR(nodes.back()[1], 0, 1e-14);
}

TEST(Catenary, ChainIsOfOrderTwo) {
  const double sag = Catenary(1, 0.8).sag_m();
  const auto error = [&](int n) { return DiscreteCatenary(n, 1, 0.8).sag_m() - sag; };
  EXPECT_NEAR(error(8), 2.24e-3, 5e-6);
  EXPECT_NEAR(error(16), 5.54e-4, 5e-7);
  EXPECT_NEAR(std::log2(error(64) / error(128)), 2, 0.01);
}

TEST(ElasticCatenary, PublishedRows) {
  const PrintedTable table("elastic_catenary.csv");
  for (const auto& row : table.rows()) {
    const double length = 0.5, weight = 0.2 * 9.81;
    const ElasticCatenary c(length, row.at("span") * length, 0.2, weight * length / row.at("eps"), 9.81);
    table.expect(c.horizontal_tension_N_per_m() / (weight * length), row.at("H"), row_text(row));
    table.expect(c.sag_m() / length, row.at("sag"), row_text(row));
  }
  EXPECT_NEAR(ElasticCatenary(1, 0.8, 1, 100, 1).sag_m(), 0.2687463, 5e-8);
}

TEST(ElasticCatenary, IsInEquilibriumAndStiffensToTheCatenary) {
  const double weight = 0.2 * 9.81;
  const ElasticCatenary c(1, 1.2, 0.2, 8, 9.81);
  EXPECT_NEAR(c.position_m(0)[0], 0, 1e-14);
  EXPECT_NEAR(c.position_m(1)[0], 1.2, 1e-14);
  const double h = 1e-6;
  for (const double s : {0.2, 0.5, 0.9}) {
    const auto p = c.position_m(s - h), q = c.position_m(s + h);
    const double dx = (q[0] - p[0]) / (2 * h), dz = (q[1] - p[1]) / (2 * h);
    EXPECT_NEAR(std::hypot(dx, dz) - 1, c.strain(s), 1e-9);
    EXPECT_NEAR(dz / dx, weight * (s - 0.5) / c.horizontal_tension_N_per_m(), 1e-9);
  }
  EXPECT_NEAR(ElasticCatenary(1, 0.8, 0.2, 1e12, 9.81).sag_m(), Catenary(1, 0.8).sag_m(), 1e-11);
}

}  // namespace
}  // namespace clothbench::truth

#include <numbers>

#include "integrated.hpp"
#include "printed_table.hpp"
#include "truth/capstan.hpp"

namespace clothbench::truth {
namespace {

constexpr double kPi = std::numbers::pi;

/// capstan_ratio with contact at vertices only, over m equal turns d = beta/m (a polygon of cloth edges on a round
/// cylinder):
///   T2/T1 = [(1 + mu tan(d/2)) / (1 - mu tan(d/2))]^m, order 2 in 1/m.
/// Source: friction cone at each vertex.
double polygonal_capstan_ratio(double friction, double wrap, int turns) {
  return std::exp(turns * 2 * std::atanh(friction * std::tan(wrap / (2 * turns))));
}

TEST(Capstan, PublishedRatios) {
  const PrintedTable table("capstan.csv");
  for (const auto& row : table.rows()) {
    const double quarters = std::round(row.at("wrap_rad") / (kPi / 2));  // printed to 10 digits only
    table.expect(capstan_ratio(row.at("friction"), quarters * kPi / 2), row.at("ratio"), row_text(row));
  }
}

TEST(Capstan, PublishedPolygons) {
  const double smooth = capstan_ratio(0.3, kPi);
  EXPECT_NEAR(polygonal_capstan_ratio(0.3, kPi, 6) / smooth - 1, 0.0245, 5e-5);
  EXPECT_NEAR(polygonal_capstan_ratio(0.3, kPi, 10) / smooth - 1, 0.0086, 5e-5);
  EXPECT_NEAR(polygonal_capstan_ratio(0.3, kPi, 20) / smooth - 1, 0.0021, 5e-5);
  EXPECT_EQ(polygonal_capstan_ratio(0, kPi, 3), 1);
  // One right-angled turn, by hand: normals at 45 degrees.
  EXPECT_NEAR(polygonal_capstan_ratio(0.3, kPi / 2, 1), (1 + 0.3 * std::tan(kPi / 4)) / (1 - 0.3 * std::tan(kPi / 4)),
              1e-14);
}

TEST(HeavyCapstan, PublishedOverhangs) {
  const PrintedTable table("heavy_capstan.csv");
  for (const auto& row : table.rows()) {
    const HeavyCapstan c{row.at("friction"), row.at("radius"), 0.37, 3.1};
    table.expect(greatest_overhang_m(c, row.at("light")), row.at("heavy"), row_text(row));
  }
}

TEST(HeavyCapstan, SolvesItsEquation) {
  using State = std::vector<double>;
  const HeavyCapstan c{0.4, 0.11, 0.3, 9.81};
  const double w = 0.3 * 9.81 * 0.11;
  for (const double phi : {0.5, 2.0, kPi}) {
    const State tension = integrated({0.8}, phi, [&](const State& t, State& d, double p) {
      d[0] = 0.4 * (t[0] + w * std::sin(p)) + w * std::cos(p);
    });
    EXPECT_NEAR(slip_tension_N_per_m(c, 0.8, phi), tension[0], 1e-12);
  }
  EXPECT_NEAR(greatest_overhang_m({0, 0.1, 0.2, 9.81}, 0.3), 0.3, 1e-15);  // no friction: balance
  EXPECT_NEAR(greatest_overhang_m({0.3, 0, 0.2, 9.81}, 0.3), 0.3 * capstan_ratio(0.3, kPi), 1e-15);
  const HeavyCapstan d{0.3, 0.05, 0.2, 9.81};
  EXPECT_TRUE(holds(d, 0.2, 0.611));
  EXPECT_FALSE(holds(d, 0.2, 0.612));
  EXPECT_FALSE(holds(d, 0.612, 0.2));
}

TEST(HeavyCapstan, PolygonIsOfOrderTwo) {
  const HeavyCapstan c{0.3, 0.05, 0.2, 9.81};
  const double smooth = greatest_overhang_m(c, 0.2);
  const auto error = [&](int m) { return polygonal_greatest_overhang_m(c, 0.2, m) - smooth; };
  EXPECT_NEAR(std::log2(error(32) / error(64)), 2, 0.05);
  EXPECT_LT(std::abs(error(2000)), 1e-6);
  // Hanging parts that outweigh the rows on the cylinder by far: the weightless ratio.
  EXPECT_NEAR(polygonal_greatest_overhang_m(c, 1e9, 10) / 1e9, polygonal_capstan_ratio(0.3, kPi, 10), 1e-8);
  // Without friction equal overhangs balance on any polygon.
  EXPECT_NEAR(polygonal_greatest_overhang_m({0, 0.05, 0.2, 9.81}, 0.2, 7), 0.2, 1e-15);
}

}  // namespace
}  // namespace clothbench::truth

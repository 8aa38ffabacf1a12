#include <algorithm>
#include <map>

#include "printed_table.hpp"
#include "truth/pendulum.hpp"
#include "truth/swinging_chain.hpp"

namespace clothbench::truth {
namespace {

/// Kinetic and potential energy, over (strip mass * g * L); 0 height at the held end.
double chain_energy(const SwingingChain& c, const ChainState& s) {
  double energy = 0;
  for (std::size_t j = 1; j < s.x_m.size(); ++j) {
    const double mass = (j + 1 < s.x_m.size() ? 1 : c.end_mass_ratio) / c.links;
    const double v2 = s.x_speed_m_per_s[j] * s.x_speed_m_per_s[j] + s.z_speed_m_per_s[j] * s.z_speed_m_per_s[j];
    energy += mass * (0.5 * v2 / (c.gravity_m_per_s2 * c.length_m) + s.z_m[j] / c.length_m);
  }
  return energy;
}

TEST(SwingingChain, PublishedRows) {
  const PrintedTable table("swinging_chain.csv");
  std::map<std::pair<int, double>, std::vector<PrintedTable::Row>> cases;
  for (const auto& row : table.rows())
    cases[{static_cast<int>(row.at("links")), row.at("end_mass_ratio")}].push_back(row);
  for (const auto& [key, rows] : cases) {
    const SwingingChain chain{key.first, 1, 9.81, key.second, 0};
    std::vector<double> times;
    for (const auto& row : rows) times.push_back(row.at("time_s"));
    const auto states = swing(chain, times);
    ASSERT_EQ(states.size(), rows.size());
    const auto tip = static_cast<std::size_t>(key.first), middle = (tip + 1) / 2;
    for (std::size_t i = 0; i < rows.size(); ++i) {
      // The published run's own error, and ours grown by the chaos that sets in after 0.5 s.
      const double own = 3 * rows[i].at("uncertainty") + 1e-12;
      table.expect(states[i].x_m[tip], rows[i].at("x_tip"), row_text(rows[i]), own);
      table.expect(states[i].z_m[tip], rows[i].at("z_tip"), row_text(rows[i]), own);
      table.expect(states[i].x_m[middle], rows[i].at("x_mid"), row_text(rows[i]), own);
      table.expect(states[i].z_m[middle], rows[i].at("z_mid"), row_text(rows[i]), own);
      EXPECT_NEAR(chain_energy(chain, states[i]), 0, 1e-11) << row_text(rows[i]);
    }
  }
}

TEST(SwingingChain, OneLinkIsAPendulum) {
  const std::vector<double> times{0.2, 0.9, 3};
  const auto states = swing({1, 0.4, 3, 0.5, 0.3}, times);
  for (std::size_t i = 0; i < times.size(); ++i) {
    const double angle = pendulum_angle_rad({0.4, 3, 3.14159265358979323846 / 2 - 0.3}, times[i]);
    EXPECT_NEAR(states[i].x_m[1], 0.4 * std::sin(angle), 1e-11);
    EXPECT_NEAR(states[i].z_m[1], -0.4 * std::cos(angle), 1e-11);
  }
}

TEST(SwingingChain, ScalesAndKeepsItsLengthsAndEnergy) {
  const std::vector<double> times{0.1, 0.2, 0.3, 0.3};
  std::vector<double> scaled;
  const double factor = std::sqrt(0.3 * 9.81 / 2.5);
  for (const double t : times) scaled.push_back(t * factor);
  const SwingingChain chain{13, 1, 9.81, 1e3, 0.2}, other{13, 0.3, 2.5, 1e3, 0.2};
  const auto a = swing(chain, times), b = swing(other, scaled);
  const double start = chain_energy(chain, swing(chain, std::vector<double>{0})[0]);
  for (std::size_t i = 0; i < times.size(); ++i) {
    for (std::size_t j = 0; j <= 13; ++j) EXPECT_NEAR(a[i].x_m[j] * 0.3, b[i].x_m[j], 1e-11);
    for (std::size_t j = 0; j < 13; ++j)
      EXPECT_NEAR(std::hypot(a[i].x_m[j + 1] - a[i].x_m[j], a[i].z_m[j + 1] - a[i].z_m[j]), 1.0 / 13, 1e-14);
    EXPECT_NEAR(chain_energy(chain, a[i]), start, 1e-9);  // of a weight of 1000 rows
  }
  EXPECT_EQ(a[2].x_m, a[3].x_m);
}

TEST(SwingingChain, SpeedsAreDerivatives) {
  const std::vector<double> times{0.3 - 1e-4, 0.3, 0.3 + 1e-4};
  const auto s = swing({16, 1, 9.81, 0.5, 0}, times);
  for (std::size_t j = 1; j <= 16; ++j) {
    EXPECT_NEAR(s[1].x_speed_m_per_s[j], (s[2].x_m[j] - s[0].x_m[j]) / 2e-4, 1e-5);
    EXPECT_NEAR(s[1].z_speed_m_per_s[j], (s[2].z_m[j] - s[0].z_m[j]) / 2e-4, 1e-5);
  }
}

TEST(SwingingChain, PointsBetweenNodes) {
  const ChainState s{0, {0, 1, 3}, {0, -2, -2}, {0, 4, 5}, {0, 0, 8}};
  EXPECT_EQ(chain_position_m(s, 0.25), (std::array<double, 2>{0.5, -1}));
  EXPECT_EQ(chain_position_m(s, 0.75), (std::array<double, 2>{2, -2}));
  EXPECT_EQ(chain_position_m(s, 1), (std::array<double, 2>{3, -2}));
}

TEST(SwingingChain, TipFallsFreelyAtFirst) {
  const auto s = swing({128, 1, 9.81, 0.5, 0}, std::vector<double>{0.3});
  EXPECT_NEAR(s[0].z_m[128], -0.5 * 9.81 * 0.09, 1e-9);
}

}  // namespace
}  // namespace clothbench::truth

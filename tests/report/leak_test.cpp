// Speed of the first leak, by what touches the cloth.
#include "report/leak.hpp"

#include <gtest/gtest.h>

#include "fake_cells.hpp"

namespace clothbench {
namespace {

CellRecord sweep_cell(const std::string& solver, double speed, double wrong, double inside_m,
                      const char* type = "hand_capsules") {
  CellRecord c = fake_cell(solver, 32, "double", 0.004);
  c.header.scene = "sweep-" + std::to_string(speed);
  c.header.scenario_json =
      std::string(R"({"name":"sweep","cloth":{"grid":[32,32],"sides":"double"},"colliders":[{"type":")") + type +
      R"("}]})";
  c.summary["imposed_speed_m_per_s"] = speed;
  c.summary["wrong_side_samples_max"] = wrong;
  c.summary["depth_vertex_max_m"] = inside_m;
  return c;
}

TEST(Leak, TheFirstSpeedThatLeaksIsTold) {
  std::vector<CellRecord> cells = {sweep_cell("a", 20, 5, 0.002),
                                   sweep_cell("a", 0.8, 0, 0),
                                   sweep_cell("a", 5, 0, 0.0009),
                                   sweep_cell("a", 10, 0, 0.0011),
                                   sweep_cell("b", 0.8, 0, 0),
                                   sweep_cell("b", 5, 0, 0),
                                   sweep_cell("b", 20, 0, 0),
                                   sweep_cell("c", 0.8, kMissing, 0),
                                   sweep_cell("c", 5, 0, 0),
                                   sweep_cell("c", 20, 0, 0),
                                   sweep_cell("d", 0.8, 0, 0),
                                   sweep_cell("d", 5, 0, 0),
                                   sweep_cell("a", 5, 0, 0, "hand_mesh")};
  cells.push_back(sweep_cell("e", 0.8, 0, 0));
  cells.push_back(sweep_cell("e", 5, 0, 0));
  cells.push_back(sweep_cell("e", 20, 0, 0));
  cells.back().outcome = {"not_finite", "F0", 7, "", {}};
  const std::vector<ContactSetUp> ups = set_ups(cells);
  const std::vector<SpeedSweep> sweeps = speed_sweeps(ups);
  ASSERT_EQ(sweeps.size(), 4u) << "d has two speeds, the hand mesh one";
  const Table t = leak_table(sweeps);
  ASSERT_EQ(t.rows.size(), 2u);
  EXPECT_EQ(t.rows[1][0], "sweep (capsules)");
  EXPECT_EQ(t.rows[1][1], "0.8…20");
  EXPECT_TRUE(t.rows[1][2].starts_with("10 m/s: inside")) << t.rows[1][2];
  EXPECT_EQ(t.rows[1][3], "none up to 20 m/s");
  EXPECT_EQ(t.rows[1][4], "0.8 m/s: wrong side not known");
  EXPECT_EQ(t.rows[1][5], "20 m/s: not_finite");
  const nlohmann::json j = leak_json(sweeps);
  EXPECT_EQ(j[0]["first_leak_m_per_s"], 10);
  EXPECT_TRUE(j[1]["first_leak_m_per_s"].is_null());
}

TEST(Leak, EachKindHasItsOwn) {
  CellRecord c = fake_cell("a", 32, "double", 0.004);
  c.summary["tunnelled_fraction_max"] = 0;
  EXPECT_EQ(leak_of("rooms", c), "");
  c.summary["tunnelled_fraction_max"] = 0.001;
  EXPECT_NE(leak_of("rooms", c), "");
  c.summary["grip_edge_ratio_max"] = 1.9;
  EXPECT_EQ(leak_of("grip", c), "");
  c.summary["grip_edge_ratio_max"] = 2.1;
  EXPECT_EQ(leak_of("grip", c), "edge pulled 2.1");
  c.summary.erase("grip_edge_ratio_max");
  EXPECT_EQ(leak_of("grip", c), "edge pulled not known");
}

/// As the runner leaves a cell of the two-hand scene.
CellRecord pulled_cell(double ratio, double bound) {
  CellRecord c = fake_cell("a", 32, "double", 0.004);
  c.header.scenario_json = R"({"name":"pull","cloth":{"grid":[32,32],"sides":"double"},"grips":[{"track":"x"}]})";
  c.summary["grip_edge_ratio_max"] = ratio;
  c.summary["strain_mean_released"] = 0.5;
  c.summary["expect.grip_edge_ratio_max"] = ratio <= bound;
  c.summary["expect.outcome"] = 1;
  return c;
}

TEST(Leak, VerdictAndFirstSpeedHangOnTheSameBounds) {
  for (const double ratio : {1.4, 1.99, 2.4, 12.0})
    for (const double bound : {1.25, 2.0, 3.0}) {
      const CellRecord c = pulled_cell(ratio, bound);
      EXPECT_EQ(verdict(c) == "kept", leak_of("grip", c).empty()) << ratio << " " << bound;
    }
  EXPECT_EQ(leak_of("grip", pulled_cell(12, 2)), "edge pulled 12");
  CellRecord other = pulled_cell(1, 2);
  other.summary["some_bound_m"] = 0.25;
  other.summary["expect.some_bound_m"] = 0;
  EXPECT_EQ(leak_of("grip", other), "some_bound_m 0.25") << "a bound without a word of its own";
}

}  // namespace
}  // namespace clothbench

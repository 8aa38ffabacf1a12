// Failure speed, by what touches the cloth.
#include "report/leak.hpp"

#include <gtest/gtest.h>

#include "fake_runs.hpp"

namespace clothbench {
namespace {

RunRecord sweep_run(const std::string& solver, double speed, double wrong, double inside_m,
                    const char* type = "hand_capsules") {
  RunRecord c = fake_run(solver, 32, "double", 0.004);
  c.header.scene = "sweep-" + std::to_string(speed);
  c.header.scenario_json =
      std::string(R"({"name":"sweep","cloth":{"grid":[32,32],"sides":"double"},"colliders":[{"type":")") + type +
      R"("}]})";
  c.summary["imposed_speed_m_per_s"] = speed;
  c.summary["crossings_max"] = wrong;
  c.summary["depth_max_m"] = inside_m;
  return c;
}

TEST(Leak, TheFailureSpeedIsReported) {
  std::vector<RunRecord> runs = {sweep_run("a", 20, 5, 0.002),
                                 sweep_run("a", 0.8, 0, 0),
                                 sweep_run("a", 5, 0, 0.0009),
                                 sweep_run("a", 10, 0, 0.0011),
                                 sweep_run("b", 0.8, 0, 0),
                                 sweep_run("b", 5, 0, 0),
                                 sweep_run("b", 20, 0, 0),
                                 sweep_run("c", 0.8, kMissing, 0),
                                 sweep_run("c", 5, 0, 0),
                                 sweep_run("c", 20, 0, 0),
                                 sweep_run("d", 0.8, 0, 0),
                                 sweep_run("d", 5, 0, 0),
                                 sweep_run("a", 5, 0, 0, "hand_mesh")};
  runs.push_back(sweep_run("e", 0.8, 0, 0));
  runs.push_back(sweep_run("e", 5, 0, 0));
  runs.push_back(sweep_run("e", 20, 0, 0));
  runs.back().outcome = {"not_finite", "F0", 7, "", {}};
  const std::vector<ContactSetUp> ups = set_ups(runs);
  const std::vector<SpeedSweep> sweeps = speed_sweeps(ups);
  ASSERT_EQ(sweeps.size(), 4u) << "d has two speeds, the hand mesh one";
  const Table t = leak_table(sweeps);
  ASSERT_EQ(t.rows.size(), 2u);
  EXPECT_EQ(t.rows[1][0], "sweep (capsules)");
  EXPECT_EQ(t.rows[1][1], "0.8…20");
  EXPECT_EQ(t.rows[1][2], "1") << "one path a speed";
  EXPECT_TRUE(t.rows[1][3].starts_with("10 m/s: inside")) << t.rows[1][3];
  EXPECT_EQ(t.rows[1][4], "none up to 20 m/s");
  EXPECT_EQ(t.rows[1][5], "0.8 m/s: crossings not known");
  EXPECT_EQ(t.rows[1][6], "20 m/s: not_finite");
  const nlohmann::json j = leak_json(sweeps);
  EXPECT_EQ(j[0]["failure_speed_m_per_s"], 10);
  EXPECT_TRUE(j[1]["failure_speed_m_per_s"].is_null());
}

TEST(Leak, CountsThePathsOfTheSpeedThatHasTheFewest) {
  std::vector<RunRecord> runs;
  for (const double speed : {1.0, 2.0, 5.0, 5.0})
    for (const char* path : {"-a", "-b"}) {
      runs.push_back(sweep_run("a", speed, 0, 0));
      runs.back().header.scene += path + std::to_string(runs.size());
    }
  const std::vector<ContactSetUp> ups = set_ups(runs);
  EXPECT_EQ(speed_sweeps(ups).at(0).paths(), 2u);
}

TEST(Leak, SaysAtWhichDistanceEachSolverHoldsTheCloth) {
  std::vector<RunRecord> runs;
  for (const double speed : {1.0, 2.0, 5.0})
    for (const char* solver : {"a", "b"}) {
      runs.push_back(sweep_run(solver, speed, 0, 0));
      runs.back().header.plan["contact_margins"] = {
          {{"collider", "hand_capsules"}, {"margin_m", solver[0] == 'a' ? 0.004 : 0.02}}};
    }
  const std::vector<ContactSetUp> ups = set_ups(runs);
  const Table t = leak_table(speed_sweeps(ups));
  ASSERT_EQ(t.rows.size(), 3u);
  EXPECT_EQ(t.rows[1], (std::vector<std::string>{kHeldAt, "–", "–", "4", "20"}));
}

TEST(Leak, EachKindHasItsOwn) {
  RunRecord c = fake_run("a", 32, "double", 0.004);
  c.summary["crossings_max"] = 0;
  EXPECT_EQ(leak_of("rooms", c), "");
  c.summary["crossings_max"] = 1;
  EXPECT_NE(leak_of("rooms", c), "");
  c.summary["grip_edge_ratio_max"] = 1.9;
  EXPECT_EQ(leak_of("grip", c), "");
  c.summary["grip_edge_ratio_max"] = 2.1;
  EXPECT_EQ(leak_of("grip", c), "edge pulled 2.1");
  c.summary.erase("grip_edge_ratio_max");
  EXPECT_EQ(leak_of("grip", c), "edge pulled not known");
}

/// As the runner leaves a run of the two-hand scene.
RunRecord pulled_run(double ratio, double bound) {
  RunRecord c = fake_run("a", 32, "double", 0.004);
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
      const RunRecord c = pulled_run(ratio, bound);
      EXPECT_EQ(verdict(c) == "pass", leak_of("grip", c).empty()) << ratio << " " << bound;
    }
  EXPECT_EQ(leak_of("grip", pulled_run(12, 2)), "edge pulled 12");
  RunRecord other = pulled_run(1, 2);
  other.summary["some_bound_m"] = 0.25;
  other.summary["expect.some_bound_m"] = 0;
  EXPECT_EQ(leak_of("grip", other), "some_bound_m 0.25") << "a bound without a word of its own";
}

}  // namespace
}  // namespace clothbench

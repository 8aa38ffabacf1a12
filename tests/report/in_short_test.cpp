#include <gtest/gtest.h>

#include "report/report.hpp"

namespace clothbench {
namespace {

RunRecord run(const std::string& solver, const std::vector<double>& means_s, const Outcome& outcome) {
  RunRecord c;
  c.header.scene = "drop";
  c.header.solver = solver;
  c.header.setting = "default";
  c.outcome = outcome;
  for (const double mean : means_s) {
    TimedTrial t;
    t.frame_wall_s.assign(12, mean);
    c.trials.push_back(t);
  }
  return c;
}

TEST(InShort, HasOutcomeTimesRatioAndRankOfEachRun) {
  Outcome broken, crashed{"crashed", "F3", 7, "its process"};
  broken.expect = "fail: depth_max_m 1 > 0";
  const Table t = in_short_table(RunTable({run("none", {}, crashed), run("slow", {4e-3, 4e-3}, broken),
                                           run("quick", {2e-3, 2e-3, 2e-3}, {}), run("bullet-soft", {4e-3}, {})}));
  ASSERT_EQ(t.rows.size(), 5u);
  using Cells = std::vector<std::string>;
  EXPECT_EQ(t.rows[0], (Cells{"scene", "solver", "outcome", "frame p50 [ms]", "p95 / p99 / worst",
                              "missed 72 / 90 Hz [%]", "trials", "× bullet-soft", "rank"}));
  EXPECT_EQ(t.rows[1], (Cells{"drop", "bullet-soft", "ok", "4.00 (4.00–4.00)", "4.00 / 4.00 / 4.00", "0.00 / 0.00", "1",
                              "1.00", "2"}));
  EXPECT_EQ(t.rows[2], (Cells{"drop", "none", "crashed at 7", "–", "–", "–", "–", "–", "–"}));
  EXPECT_EQ(t.rows[3], (Cells{"drop", "quick", "ok", "2.00 (2.00–2.00)", "2.00 / 2.00 / 2.00", "0.00 / 0.00", "3",
                              "2.00 (2.00–2.00)", "1"}));
  EXPECT_EQ(t.rows[4][2] + " " + t.rows[4][8], "fail –");
}

TEST(InShort, AClothThatIsTornApartHasNoRankAndFewerFramesAreTold) {
  RunRecord torn = run("torn", {1e-3}, {}), held = run("held", {2e-3}, {}), cut = run("cut", {3e-3}, {});
  torn.summary["stretch_max_last_second"] = 3.57;
  held.summary["stretch_max_last_second"] = 0.05;
  cut.trials[0].frame_wall_s.resize(5);
  const Table t = in_short_table(RunTable({torn, held, cut}));
  ASSERT_EQ(t.rows.size(), 4u);
  EXPECT_EQ(t.rows[0][3] + ", " + t.rows[0].back(), "stretch [%], rank") << "no baseline is present";
  EXPECT_EQ(t.rows[1][4], "3.00 (first 5 frames)") << "too few frames for an interval";
  EXPECT_EQ(t.rows[2][1] + " " + t.rows[2][3] + " " + t.rows[2].back(), "held 5.00 1");
  EXPECT_EQ(t.rows[3][1] + " " + t.rows[3][3] + " " + t.rows[3].back(), "torn 357 –");
}

}  // namespace
}  // namespace clothbench

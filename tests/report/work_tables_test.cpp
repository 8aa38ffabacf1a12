// What the report of error against run time makes of points that are known.
#include <gtest/gtest.h>

#include <cmath>
#include <stdexcept>

#include "report/work_precision.hpp"

namespace clothbench {
namespace {

using nlohmann::json;

RunRecord run(const std::string& solver, const std::string& setting, double frame_s, double error,
              const std::string& status = "ok") {
  RunRecord c;
  c.header.scene = "swing";
  c.header.solver = solver;
  c.header.setting = setting;
  c.header.settings = json::object();
  c.header.scenario_json = R"({"name":"swing","truth":{"case":"swing-strip"},"time":{"frame_rate_hz":60}})";
  c.header.environment = {{"gpu", "CPU"}};
  c.outcome.status = status;
  c.summary = {{"frame_wall_median_s", frame_s},
               {"truth_error", error},
               {"reference_uncertainty", 1e-5},
               {"truth_space_error", 2e-3}};
  return c;
}

const std::vector<std::string>& row_of(const Table& t, const std::string& solver) {
  for (const auto& row : t.rows)
    if (row.at(1) == solver) return row;
  throw std::runtime_error("no row of " + solver);
}

TEST(WorkTable, FindsTheFrontAndTimesToAccuracy) {
  const std::vector<RunRecord> runs = {run("a", "fast", 1e-3, 0.5),
                                       run("a", "good", 4e-3, 8e-3),
                                       run("a", "worse", 5e-3, 9e-3),
                                       run("a", "best", 0.1, 5e-4),
                                       run("a", "lost", 1e-3, 1e-9, "not_finite"),
                                       run("b", "tiny", 2e-3, 1e-6),
                                       run("b", "nan", 2e-3, NAN)};
  const auto diagrams = work_diagrams(runs);
  ASSERT_EQ(diagrams.size(), 1u);
  std::vector<std::string> front;
  for (const WorkPoint& p : diagrams[0].points)
    if (p.on_front) front.push_back(p.setting);
  EXPECT_EQ(front, (std::vector<std::string>{"fast", "good", "best", "tiny"}));
  EXPECT_NEAR(diagrams[0].points[0].wall_ms_per_s, 60, 1e-9) << "1 ms a frame at 60 Hz";
  const Table t = work_table(diagrams);
  EXPECT_EQ(row_of(t, "a")[2], "240 (good)");
  EXPECT_EQ(row_of(t, "a")[3], "6e+03 (best)");
  EXPECT_EQ(row_of(t, "a")[4], "0.008 (good)") << "6 s a second is not real time";
  EXPECT_EQ(row_of(t, "a")[6], "1 of 5");
  EXPECT_EQ(row_of(t, "b")[5], "≤ 0.002 (tiny)") << "no solver is better than the mesh itself";
  EXPECT_EQ(row_of(t, "b")[6], "1 of 2");
  EXPECT_EQ(diagrams[0].refused(), "")
      << "the best error is below 3 U_ref, and so below the mesh's own: no solver is ranked there";
}

TEST(WorkTable, TimesArePipelinedWhereASolverCan) {
  std::vector<RunRecord> runs = {run("a", "x", 4e-3, 5e-3), run("b", "x", 2e-3, 5e-3)};
  runs[0].summary["frame_pipelined_median_s"] = 1e-3;
  runs[1].summary["frame_pipelined_median_s"] = NAN;
  const auto diagrams = work_diagrams(runs);
  const Table t = work_table(diagrams);
  EXPECT_EQ(row_of(t, "a")[2], "60 (x)");
  EXPECT_EQ(row_of(t, "a")[7], "240 (x)") << "from submission to fence";
  EXPECT_EQ(row_of(t, "b")[2], "120 (x)") << "it waits for each frame";
  EXPECT_EQ(row_of(t, "b")[7], "120 (x)");
  EXPECT_NE(winners_table(diagrams).rows[1][2].find("a ("), std::string::npos) << "ranked by the pipelined time";
}

TEST(BudgetTable, NamesWhoHasTheSmallerErrorAtAnyBudget) {
  // 0.02 and 0.04 at 0.3 ms: between the budgets that have a column.
  const std::vector<RunRecord> runs = {run("a", "x", 1e-4, 0.3), run("a", "y", 1e-3, 0.04), run("b", "x", 3e-4, 0.02),
                                       run("b", "late", 2e-2, 1e-9), run("a", "nan", 1e-4, NAN)};
  const Table t = budget_table(work_diagrams(runs));
  EXPECT_EQ(row_of(t, "a").at(3), "0.3") << "0.1 ms";
  EXPECT_EQ(row_of(t, "a").at(2), "–") << "0.05 ms";
  EXPECT_EQ(row_of(t, "a").at(6), "0.04") << "1 ms";
  EXPECT_EQ(row_of(t, "a").back(), "b: 15 times at 0.3 ms");
  EXPECT_EQ(row_of(t, "b").back(), "a: 0.3 at 0.1 ms, where this solver has no result");
  const std::vector<RunRecord> small = {run("a", "x", 1e-4, 1e-6), run("b", "x", 1e-4, 1e-9)};
  EXPECT_EQ(row_of(budget_table(work_diagrams(small)), "a").back(), "never")
      << "below the mesh's own error no solver is better";
  EXPECT_EQ(row_of(budget_table(work_diagrams(small)), "a").at(3), "≤ 0.002");
}

TEST(EnergyTable, CountsSettingsThatGainNaNIncluded) {
  std::vector<RunRecord> runs = {run("a", "x", 1e-4, 0.3), run("a", "y", 1e-4, 0.3), run("b", "x", 1e-4, 0.3)};
  runs[0].summary["energy_gain"] = 1e-4;
  runs[1].summary["energy_gain"] = 2e-3;
  const Table t = energy_table(work_diagrams(runs));
  ASSERT_EQ(t.rows.size(), 2u) << "b's energy is not known";
  EXPECT_EQ(row_of(t, "a"), (std::vector<std::string>{"swing", "a", "2.0e-03", "y", "1 of 2"}));
}

TEST(WorkTable, WhatIsOverBudgetIsNoFailure) {
  const std::vector<RunRecord> runs = {run("a", "x", 4e-3, 5e-3), run("a", "y", NAN, NAN, "over_budget"),
                                       run("a", "z", 1e-3, NAN, "diverged")};
  EXPECT_EQ(row_of(work_table(work_diagrams(runs)), "a")[6], "1 of 3, 1 not run");
}

TEST(WorkTable, RefusesWithoutACertainReference) {
  std::vector<RunRecord> runs = {run("a", "x", 1e-3, 1e-4)};
  EXPECT_EQ(work_diagrams(runs)[0].refused(), "");
  runs[0].summary["truth_space_error"] = 1e-3;
  runs[0].summary["reference_uncertainty"] = 1e-4 / 2;
  EXPECT_EQ(work_diagrams(runs)[0].refused(), "") << "the mesh's own error is above 3 U_ref";
  runs[0].summary["truth_space_error"] = 0;
  EXPECT_NE(work_diagrams(runs)[0].refused(), "");
  EXPECT_NE(truth_table(work_diagrams(runs)).markdown().find("REFUSED"), std::string::npos);
  runs[0].summary["reference_uncertainty"] = NAN;
  EXPECT_EQ(work_diagrams(runs)[0].refused(), "no reference solution");
  runs[0].header.scenario_json = "{}";
  EXPECT_TRUE(work_diagrams(runs).empty());
}

}  // namespace
}  // namespace clothbench

// The report of error against run time, for known points.
#include <gtest/gtest.h>

#include <cmath>

#include "fake_runs.hpp"

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

constexpr const char* kWork = "Error against run time";
constexpr const char* kCases = "Reference cases and their reference solutions";

/// Cell of the first scene in the solver's row, even if ranking is refused.
std::string value(const std::vector<RunRecord>& runs, const std::string& title, const std::string& solver,
                  const std::string& head) {
  const Table t = table_of(runs, title);
  return entry(t, t.rows.at(1).at(0), solver, head);
}

std::string refused(const std::vector<RunRecord>& runs) { return RunTable(runs).rows().at(0).truth->refused(); }

TEST(WorkTable, FindsTheFrontAndTimesToAccuracy) {
  const std::vector<RunRecord> runs = {run("a", "fast", 1e-3, 0.5),
                                       run("a", "good", 4e-3, 8e-3),
                                       run("a", "worse", 5e-3, 9e-3),
                                       run("a", "best", 0.1, 5e-4),
                                       run("a", "lost", 1e-3, 1e-9, "not_finite"),
                                       run("b", "tiny", 2e-3, 1e-6),
                                       run("b", "nan", 2e-3, NAN)};
  EXPECT_EQ(value(runs, kWork, "a", "to 1 %"), "240 (good)") << "4 ms per frame at 60 Hz";
  EXPECT_EQ(value(runs, kWork, "a", "to 0.1 %"), "6e+03 (best)");
  EXPECT_EQ(value(runs, kWork, "a", "error within 13.9 ms"), "0.008 (good)") << "0.1 s per frame is not real time";
  EXPECT_EQ(value(runs, kWork, "a", "failed"), "1 of 5");
  EXPECT_EQ(value(runs, kWork, "b", "best error"), "≤ 0.002 (tiny)") << "no solver is better than the mesh itself";
  EXPECT_EQ(value(runs, kWork, "b", "failed"), "1 of 2");
  EXPECT_EQ(value({run("a", "x", NAN, 5e-3)}, kWork, "a", "best error"), "0.005 (x)") << "the run has no time";
  EXPECT_EQ(refused(runs), "")
      << "the best error is below 3 U_ref, and so below the mesh's own: no solver is ranked there";
}

TEST(WorkTable, TimesArePipelinedWhereASolverCan) {
  std::vector<RunRecord> runs = {run("a", "x", 4e-3, 5e-3), run("b", "x", 2e-3, 5e-3)};
  runs[0].summary["frame_pipelined_median_s"] = 1e-3;
  runs[1].summary["frame_pipelined_median_s"] = NAN;
  EXPECT_EQ(value(runs, kWork, "a", "to 1 %"), "60 (x)");
  EXPECT_EQ(value(runs, kWork, "b", "to 1 %"), "120 (x)") << "it waits for each frame";
}

TEST(WorkTable, ASolverWithoutTheStiffnessIsNotRanked) {
  std::vector<RunRecord> runs = {run("a", "x", 1e-3, 5e-3), run("b", "x", 1e-3, 5e-3)};
  for (RunRecord& c : runs) c.summary["truth_dependence_B"] = 0.5;
  runs[0].header.plan["left_out"] = {{{"what", "bending"}, {"why", "none here"}, {"no_parameter", "B"}}};
  EXPECT_EQ(value(runs, kWork, "a", "ranked"), "NO: the run has no bending: none here");
  EXPECT_EQ(value(runs, kWork, "b", "ranked"), "yes");
  for (RunRecord& c : runs) c.summary["truth_dependence_B"] = 0.001;
  EXPECT_EQ(value(runs, kWork, "a", "ranked"), "yes") << "the scene does not depend on it";
}

TEST(WorkTable, HasTheSmallestErrorOfSettingsThatFitABudget) {
  const std::vector<RunRecord> runs = {run("a", "x", 1e-4, 0.3), run("a", "y", 1e-3, 0.04), run("b", "x", 3e-4, 1e-9),
                                       run("a", "nan", 1e-4, NAN)};
  EXPECT_EQ(value(runs, kWork, "b", "error within 0.1 ms"), "–");
  EXPECT_EQ(value(runs, kWork, "a", "error within 0.1 ms"), "0.3 (x)");
  EXPECT_EQ(value(runs, kWork, "a", "error within 1 ms"), "0.04 (y)");
  EXPECT_EQ(value(runs, kWork, "b", "error within 1 ms"), "≤ 0.002 (x)") << "the mesh's own error";
  const Tile::Entry best = tiles_of(RunTable(runs)).at(0).entries[0];
  EXPECT_EQ(best.value + in_brackets(best.about), "1/1 (21–100 %, 0 trials)");
}

TEST(WorkTable, WhatIsOverBudgetIsNoFailure) {
  const std::vector<RunRecord> runs = {run("a", "x", 4e-3, 5e-3), run("a", "y", NAN, NAN, "over_budget"),
                                       run("a", "z", 1e-3, NAN, "diverged")};
  EXPECT_EQ(value(runs, kWork, "a", "failed"), "1 of 3, 1 not run");
}

TEST(WorkTable, HasTailsOfTheFastestSettingToOnePercent) {
  std::vector<RunRecord> runs = {run("a", "x", 4e-3, 5e-3), run("a", "y", 1e-3, 0.3), run("b", "x", 2e-3, 0.3)};
  for (RunRecord& c : runs) c.trials.resize(1);
  for (int f = 1; f <= 100; ++f) runs[0].trials[0].frame_wall_s.push_back(1e-3 * f);
  runs[1].trials[0].frame_wall_s = {1e-3};
  runs[2].trials[0].frame_wall_s = {2e-3};
  EXPECT_TRUE(value(runs, kWork, "a", "frame p50 [ms]").starts_with("50.0 ("));
  EXPECT_EQ(value(runs, kWork, "a", "p95 / p99 / worst [ms]"), "95.0 / 99.0 / 100");
  EXPECT_EQ(value(runs, kWork, "a", "missed 72 / 90 Hz [%]"), "87.0 / 89.0");
  EXPECT_EQ(value(runs, kWork, "a", "real-time factor"), "0.333");
  EXPECT_EQ(value(runs, kWork, "b", "real-time factor"), "8.33") << "none to 1 %: the most accurate";
  EXPECT_EQ(value(runs, kWork, "a", "ranked"), "no: ~") << "its interval is too wide";
}

TEST(WorkTable, RefusesWithoutACertainReference) {
  std::vector<RunRecord> runs = {run("a", "x", 1e-3, 1e-4)};
  EXPECT_EQ(refused(runs), "");
  runs[0].summary["truth_space_error"] = 1e-3;
  runs[0].summary["reference_uncertainty"] = 1e-4 / 2;
  EXPECT_EQ(refused(runs), "") << "the mesh's own error is above 3 U_ref";
  runs[0].summary["truth_space_error"] = 0;
  EXPECT_NE(refused(runs), "");
  EXPECT_NE(table_of(runs, kCases).markdown().find("REFUSED"), std::string::npos);
  runs[0].summary["reference_uncertainty"] = NAN;
  EXPECT_EQ(refused(runs), "no reference solution");
  runs[0].header.scenario_json = "{}";
  EXPECT_TRUE(tables_titled(runs, kWork).empty());
}

}  // namespace
}  // namespace clothbench

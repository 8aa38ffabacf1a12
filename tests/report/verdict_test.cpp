// A run counts as passed or not equally in every table, on the console and in JSON.
#include "report/verdict.hpp"

#include <gtest/gtest.h>

#include "clothbench/feature.hpp"
#include "fake_runs.hpp"

namespace clothbench {
namespace {

constexpr const char* kDrawn =
    R"({"drawn":{"kind":"push","speed_m_per_s":3},"colliders":[{"type":"sphere"}],"expect":{"outcome":"ok","depth_max_m":{"at_most":1}}})";

/// A run of a scene with contact and one bound, passed or not.
RunRecord judged(const std::string& solver, bool passed, const std::string& scenario = kDrawn) {
  RunRecord c = fake_run(solver, 8, "single", 1e-3);
  c.header.scenario_json = scenario;
  c.summary["expect.depth_max_m"] = passed ? 1 : 0;
  c.summary["expect.outcome"] = 1;
  c.outcome.expect = passed ? "pass" : "fail: depth_max_m 2 > 1";
  return c;
}

/// As `ballistic` declares it.
RunRecord without_contact() {
  RunRecord c = judged("ballistic", true);
  nlohmann::json ignored = {name_of(Feature::MovingPins)};
  kColliderFeatures.for_each([&](Feature f) { ignored.push_back(name_of(f)); });
  c.header.environment["solver_features"] = {{"ignores", ignored}};
  return c;
}

std::vector<RunRecord> mixed() {
  RunRecord unsupported = with_outcome(judged("c", true), "unsupported", -1, "no sphere"),
            crashed = with_outcome(judged("d", true), "crashed", 4, "its process");
  RunRecord unknown = judged("e", true);
  unknown.summary["expect.depth_max_m"] = kMissing;
  unknown.outcome.expect = "not measured";
  return {judged("a", true), judged("b", false), unsupported, crashed, unknown, without_contact()};
}

TEST(Verdict, CountsWhatTheTableSays) {
  const VerdictCounts n = count_verdicts(mixed());
  EXPECT_EQ(n.runs, 6u);
  EXPECT_EQ(n.passed, 1u);
  EXPECT_EQ(n.failed(), 2u);
  EXPECT_EQ(n.ignored, 1u);
  EXPECT_EQ(n.unsupported, 1u);
  EXPECT_EQ(n.not_measured, 1u);
  EXPECT_EQ(n.text(), "1 of 6 runs passed, 2 failed, 1 ignored contact, 1 unsupported, 1 not measured");
}

TEST(Verdict, ASolverWithoutContactPassesNothingAnywhere) {
  const std::vector<RunRecord> runs = {without_contact()};
  EXPECT_EQ(verdict(runs[0]), "ignored");
  EXPECT_EQ(count_verdicts(runs).text(), "0 of 1 runs passed, 1 ignored contact");
  EXPECT_EQ(in_short_table(RunTable(runs)).rows[1][2], "ignored");
  EXPECT_EQ(table_of(runs, "Randomly generated contact scenes: pass rate by speed [m/s]").rows[1].back().substr(0, 3),
            "0/1");
  EXPECT_EQ(runs_json(runs)[0]["verdict"], "ignored");
  const auto csv = parse_csv(runs_csv(RunTable(runs)));
  for (std::size_t k = 0; k < csv[0].size(); ++k)
    if (csv[0][k] == "verdict") {
      EXPECT_EQ(csv[1][k], "ignored");
    }
}

TEST(Verdict, AFailureCountsBesideABoundThatIsNotMeasuredAndAlsoForWhoIgnoresContact) {
  for (RunRecord c : {judged("a", false), without_contact()}) {
    c.summary["expect.depth_max_m"] = 0;
    c.summary["expect.stretch_max"] = kMissing;
    EXPECT_EQ(verdict(c), "fail") << c.header.solver;
    EXPECT_EQ(verdict(with_outcome(c, "diverged", 17, "")), "diverged at 17");
  }
}

TEST(Verdict, WhereThereIsNoContactItIsNotIgnored) {
  RunRecord c = without_contact();
  c.header.scenario_json = R"({"expect":{"stretch_max":{"at_most":1}}})";
  EXPECT_EQ(verdict(c), "pass");
}

TEST(Verdict, AScenesOutcomeAloneIsNoBound) {
  RunRecord ended = judged("a", true, R"({"colliders":[{"type":"sphere"}],"expect":{"outcome":"ok"}})");
  ended.summary = {{"expect.outcome", 1}};
  EXPECT_EQ(bounds_of(ended), 0u);
  RunRecord crashed = with_outcome(judged("b", true, R"({"cloth":{},"truth":{"case":"free-fall"}})"), "crashed", 4, "");
  crashed.summary.clear();
  EXPECT_EQ(count_verdicts({crashed}).text(), "0 of 1 runs passed, 1 failed") << "it has no motion that is right";
  RunRecord missing = judged("c", true);
  missing.outcome.status = "missing";
  EXPECT_EQ(count_verdicts({ended, missing, judged("d", true)}).text(), "1 of 1 runs passed");
}

TEST(Verdict, WhatJudgesTheMotionFailsWithoutABound) {
  RunRecord c = judged("a", true);
  c.outcome.expect = "fail: kinematic 0.4 > 0.001";
  EXPECT_EQ(verdict(c), "fail");
  EXPECT_EQ(count_verdicts({c}).passed, 0u);
}

}  // namespace
}  // namespace clothbench

// Ladders of settings: where they end for want of time, and what is stored of the rest; and trials that agree.
#include <thread>

#include "small_runs.hpp"

namespace clothbench {
namespace {

RunSpec rung(const SolverEntry& e, int work) {
  RunSpec s;
  s.entry = &e;
  s.work = work;
  return s;
}

TEST(LadderBudget, EndsWhereTheNextRungWouldNotFit) {
  SolverEntry a, b;
  a.info.name = "a";
  b.info.name = "b";
  LadderBudget budget(10);
  EXPECT_EQ(budget.refused(rung(a, 256)), "") << "the first always runs";
  budget.spent(rung(a, 1), 1, "ok");
  budget.spent(rung(a, 2), 2, "ok");
  EXPECT_EQ(budget.refused(rung(a, 4)), "") << "3 s are spent and 4 to come";
  budget.spent(rung(a, 4), 4, "ok");
  EXPECT_NE(budget.refused(rung(a, 8)).find("about 8 s, but only 3 of the 10 s"), std::string::npos)
      << budget.refused(rung(a, 8));
  EXPECT_EQ(budget.refused(rung(b, 8)), "") << "another solver's time";
  EXPECT_EQ(budget.refused(rung(a, 0)), "") << "not on the ladder";
  EXPECT_EQ(budget.run_limit_s(rung(a, 4), 20), 5) << "3 s are left, but half of all is allowed";
  EXPECT_EQ(budget.run_limit_s(rung(b, 4), 20), 10);
  EXPECT_EQ(budget.run_limit_s(rung(b, 0), 20), 20);
  EXPECT_EQ(LadderBudget(0).run_limit_s(rung(b, 4), 0), 0);
}

TEST(LadderBudget, ATimeOutEndsTheLadderWithoutAnyLimit) {
  SolverEntry a;
  a.info.name = "a";
  LadderBudget budget(0);
  budget.spent(rung(a, 64), 1000, "ok");
  EXPECT_EQ(budget.refused(rung(a, 128)), "");
  budget.spent(rung(a, 64), 20, "timed_out");
  EXPECT_EQ(budget.refused(rung(a, 64)), "") << "as much work may be quicker in another split";
  EXPECT_NE(budget.refused(rung(a, 256)).find("4 times the work of a setting that timed out"), std::string::npos);
}

class Ladder : public SmallRuns {};

TEST_F(Ladder, WhatWouldTakeTooLongIsStoredWithItsReason) {
  const SolverEntry entry = ballistic_with([](ClothSolver& inner, const nlohmann::json& s, const FrameInput& f) {
    std::this_thread::sleep_for(std::chrono::milliseconds(s["substeps"].get<int>()));
    return inner.step(f);
  });
  std::vector<RunSpec> rungs;
  for (const int substeps : {10, 20, 80, 160})
    rungs.push_back({&scene_, &entry, {{"substeps", substeps}}, "substeps=" + std::to_string(substeps), substeps});
  RunPlan plan = plan_of(rungs, 4, 5, 0.1);
  plan.rules.ladder_limit_s = 0.5;
  plan.rules.agree = 0.5;  // a sleep is never that far off by itself
  const RunResult result = execute_runs(plan, options_);
  EXPECT_EQ(result.runs_ok, 2);
  EXPECT_EQ(result.runs_over_budget, 2);
  EXPECT_EQ(result.runs_failed, 0);
  EXPECT_TRUE(result.faults.empty());
  EXPECT_GT(result.seconds.at("ballistic"), 0.2);
  std::map<std::string, RunRecord> runs;
  for (const std::filesystem::path& f : result.files) {
    RunRecord c = read_run(f);
    runs[c.header.setting] = std::move(c);
  }
  EXPECT_EQ(runs.at("substeps=80").outcome.status, "over_budget");
  EXPECT_NE(runs.at("substeps=80").outcome.message.find("not run"), std::string::npos);
  EXPECT_TRUE(runs.at("substeps=160").trials.empty());
  EXPECT_LT(runs.at("substeps=10").trials.size(), 4u) << "trials that agree are enough";
  EXPECT_GE(runs.at("substeps=10").trials.size(), 2u);
  EXPECT_GT(runs.at("substeps=20").summary.at("untimed_s"), 0.1);
}

TEST_F(Ladder, AllTrialsRunUnlessAskedOtherwise) {
  const SolverEntry& entry = find_solver("ballistic");
  const RunRecord c =
      read_run(execute_runs(plan_of({{&scene_, &entry, nlohmann::json::object()}}, 3, 5), options_).files.at(0));
  EXPECT_EQ(c.trials.size(), 3u);
  EXPECT_TRUE(std::isnan(c.trials[0].pipelined_wall_s)) << "not asked for, and the CPU waits anyway";
}

}  // namespace
}  // namespace clothbench

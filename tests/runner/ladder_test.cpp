// Ladders of settings: where they end, and what is stored of the rest; and trials that agree.
#include <thread>

#include "small_runs.hpp"

namespace clothbench {
namespace {

class Ladder : public SmallRuns {};

TEST_F(Ladder, EndsAtATimeOutAndStoresTheRestWithItsReason) {
  const SolverEntry entry = ballistic_with([](ClothSolver& inner, const nlohmann::json& s, const FrameInput& f) {
    std::this_thread::sleep_for(std::chrono::milliseconds(s["substeps"].get<int>()));
    return inner.step(f);
  });
  std::vector<RunSpec> rungs;
  for (const int substeps : {10, 20, 80, 160, 320})
    rungs.push_back({&scene_, &entry, {{"substeps", substeps}}, "substeps=" + std::to_string(substeps), substeps});
  RunPlan plan = plan_of(rungs, 4, 5, 0.1);
  plan.rules.run_limit_s = 0.4;
  plan.rules.agree = 0.5;  // a sleep is never that far off by itself
  const RunResult result = execute_runs(plan, options_);
  EXPECT_TRUE(result.faults.empty());
  std::map<std::string, RunRecord> runs;
  for (const std::filesystem::path& f : result.files) {
    RunRecord c = read_run(f);
    runs[c.header.setting] = std::move(c);
  }
  for (const char* rung : {"substeps=10", "substeps=20"}) EXPECT_EQ(runs.at(rung).outcome.status, "ok");
  EXPECT_EQ(runs.at("substeps=80").outcome.status, "timed_out");
  EXPECT_EQ(runs.at("substeps=160").outcome.status, "over_budget");
  EXPECT_EQ(runs.at("substeps=320").outcome.status, "over_budget");
  EXPECT_EQ(runs.at("substeps=320").outcome.message, "not run: 4 times the work of a setting that timed out");
  EXPECT_TRUE(runs.at("substeps=320").trials.empty());
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

// Ladders of settings: where they end for want of time, and what is stored of the rest; and trials that agree.
#include "runner/ladder.hpp"

#include <gtest/gtest.h>
#include <unistd.h>

#include <filesystem>
#include <thread>

#include "runner/study_runner.hpp"
#include "scenario/load.hpp"

namespace clothbench {
namespace {

namespace fs = std::filesystem;

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

/// Falls, each frame as many milliseconds long as `substeps` says.
class Slow final : public ClothSolver {
 public:
  Slow(std::unique_ptr<ClothSolver> inner, double frame_s) : inner_(std::move(inner)), frame_s_(frame_s) {}
  const SolverInfo& info() const override { return inner_->info(); }
  DeviceInfo device() const override { return inner_->device(); }
  void load(const Scene& s) override { inner_->load(s); }
  void reset() override { inner_->reset(); }
  StepStatus step(const FrameInput& f) override {
    std::this_thread::sleep_for(std::chrono::duration<double>(frame_s_));
    return inner_->step(f);
  }
  void read_state(ClothState& s) const override { inner_->read_state(s); }
  FrameCost last_cost() const override { return inner_->last_cost(); }
  Plan plan() const override { return inner_->plan(); }

 private:
  std::unique_ptr<ClothSolver> inner_;
  double frame_s_;
};

TEST(Ladder, WhatWouldTakeTooLongIsStoredWithItsReason) {
  const Scene scene = load_scene("paper/gravity", {"cloth.grid=[4,4]"});
  SolverEntry entry = find_solver("ballistic");
  const auto fast = entry.make;
  entry.make = [&](const nlohmann::json& s, const DeviceOptions& d) {
    return std::make_unique<Slow>(fast(nlohmann::json::object(), d), 1e-3 * s["substeps"].get<int>());
  };
  RunPlan plan;
  plan.protocol = "test";
  plan.rules.trials = 4;
  plan.rules.frames = 5;
  plan.rules.warmup_s = 0;
  plan.rules.accuracy_duration_s = 0.1;
  plan.rules.ladder_limit_s = 0.5;
  plan.rules.agree = 0.5;  // a sleep is never that far off by itself
  plan.groups.emplace_back();
  for (const int substeps : {10, 20, 80, 160}) {
    RunSpec s{&scene, &entry, {{"substeps", substeps}}, "substeps=" + std::to_string(substeps), substeps};
    plan.groups[0].push_back(s);
  }
  const fs::path out = fs::temp_directory_path() / ("clothbench-ladder-" + std::to_string(getpid()));
  fs::create_directories(out);
  RunOptions options;
  options.out = out;
  const RunResult result = execute_runs(plan, options);
  EXPECT_EQ(result.runs_ok, 2);
  EXPECT_EQ(result.runs_over_budget, 2);
  EXPECT_EQ(result.runs_failed, 0);
  EXPECT_TRUE(result.faults.empty());
  EXPECT_GT(result.seconds.at("ballistic"), 0.2);
  std::map<std::string, RunRecord> runs;
  for (const fs::path& f : result.files) {
    RunRecord c = read_run(f);
    runs[c.header.setting] = std::move(c);
  }
  EXPECT_EQ(runs.at("substeps=80").outcome.status, "over_budget");
  EXPECT_NE(runs.at("substeps=80").outcome.message.find("not run"), std::string::npos);
  EXPECT_TRUE(runs.at("substeps=160").trials.empty());
  EXPECT_LT(runs.at("substeps=10").trials.size(), 4u) << "trials that agree are enough";
  EXPECT_GE(runs.at("substeps=10").trials.size(), 2u);
  EXPECT_GT(runs.at("substeps=20").summary.at("untimed_s"), 0.1);
  fs::remove_all(out);
}

TEST(Ladder, AllTrialsRunUnlessAskedOtherwise) {
  const Scene scene = load_scene("paper/gravity", {"cloth.grid=[4,4]"});
  RunPlan plan;
  plan.protocol = "test";
  plan.rules.trials = 3;
  plan.rules.frames = 5;
  plan.rules.warmup_s = 0;
  plan.rules.accuracy_duration_s = 0.05;
  const SolverEntry& entry = find_solver("ballistic");
  plan.groups = {{{&scene, &entry, nlohmann::json::object(), "default"}}};
  const fs::path out = fs::temp_directory_path() / ("clothbench-trials-" + std::to_string(getpid()));
  fs::create_directories(out);
  RunOptions options;
  options.out = out;
  const RunRecord c = read_run(execute_runs(plan, options).files.at(0));
  EXPECT_EQ(c.trials.size(), 3u);
  EXPECT_TRUE(std::isnan(c.trials[0].pipelined_wall_s)) << "not asked for, and the CPU waits anyway";
  fs::remove_all(out);
}

}  // namespace
}  // namespace clothbench

// A run held in the middle of a trial, as a paused activity holds it.
#include <gtest/gtest.h>
#include <unistd.h>

#include <chrono>
#include <filesystem>
#include <thread>

#include "clothbench/record.hpp"
#include "runner/interrupt.hpp"
#include "runner/study_runner.hpp"
#include "scenario/load.hpp"

namespace clothbench {
namespace {

namespace fs = std::filesystem;
using namespace std::chrono_literals;

/// The ballistic solver, which calls a function at every step.
class Watched final : public ClothSolver {
 public:
  Watched(std::unique_ptr<ClothSolver> inner, std::function<void()> at_step)
      : inner_(std::move(inner)), at_step_(std::move(at_step)) {}
  const SolverInfo& info() const override { return inner_->info(); }
  DeviceInfo device() const override { return inner_->device(); }
  void load(const Scene& s) override { inner_->load(s); }
  void reset() override { inner_->reset(); }
  StepStatus step(const FrameInput& f) override {
    at_step_();
    return inner_->step(f);
  }
  void read_state(ClothState& s) const override { inner_->read_state(s); }
  FrameCost last_cost() const override { return inner_->last_cost(); }
  Plan plan() const override { return inner_->plan(); }

 private:
  std::unique_ptr<ClothSolver> inner_;
  std::function<void()> at_step_;
};

TEST(Hold, ATrialThatWasHeldIsRunAgainAndTheWaitIsNotTimed) {
  const Scene scene = load_scene("paper/gravity", {"cloth.grid=[4,4]"});
  const SolverEntry& ballistic = find_solver("ballistic");
  int steps = 0;
  std::thread release;
  SolverEntry entry = ballistic;
  RunPlan plan;
  plan.protocol = "test";
  plan.rules.trials = 1;
  plan.rules.frames = 20;
  plan.rules.warmup_s = 0;
  plan.rules.accuracy_duration_s = 0.05;
  const int in_trial = 4 + 3 + 10;  // accuracy pass, warm-up, then the tenth frame of the trial
  entry.make = [&](const nlohmann::json& s, const DeviceOptions& d) {
    return std::make_unique<Watched>(ballistic.make(s, d), [&] {
      if (++steps != in_trial) return;
      hold_runs(true);
      release = std::thread([] {
        std::this_thread::sleep_for(300ms);
        hold_runs(false);
      });
    });
  };
  plan.groups = {{{&scene, &entry, nlohmann::json::object(), "default"}}};
  const fs::path out = fs::temp_directory_path() / ("clothbench-hold-" + std::to_string(getpid()));
  fs::create_directories(out);
  const auto start = std::chrono::steady_clock::now();
  RunOptions options;
  options.out = out;
  const RunResult result = execute_runs(plan, options);
  EXPECT_GE(std::chrono::steady_clock::now() - start, 280ms) << "it did wait";
  ASSERT_TRUE(release.joinable());
  release.join();
  EXPECT_EQ(result.runs_ok, 1);
  EXPECT_EQ(steps, 4 + 2 * (3 + 20)) << "one accuracy pass, two trials with their warm-ups";
  const RunRecord record = read_run(result.files.at(0));
  ASSERT_EQ(record.trials.size(), 1u);
  EXPECT_EQ(record.trials[0].frames(), 20);
  for (double w : record.trials[0].frame_wall_s) EXPECT_LT(w, 0.2);
  EXPECT_TRUE(record.summary.count("temperature_end_C") == 1 && record.summary.count("cpu_clock_start_Hz") == 1);
  fs::remove_all(out);
}

TEST(Hold, AnInterruptEndsAHeldRun) {
  hold_runs(true);
  request_interrupt();
  const Scene scene = load_scene("paper/gravity", {"cloth.grid=[4,4]"});
  SolverRun run({&scene, &find_solver("ballistic"), nlohmann::json::object(), "default"}, {}, "test");
  TrialRules rules;
  rules.accuracy_duration_s = 0.1;
  EXPECT_THROW(run.run_accuracy(rules), Error);
  clear_interrupt();
  hold_runs(false);
  EXPECT_NO_THROW(run.run_accuracy(rules));
}

}  // namespace
}  // namespace clothbench

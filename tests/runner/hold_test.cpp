// A run held in the middle of a trial, as a paused activity holds it.
#include <chrono>
#include <thread>

#include "clothbench/record.hpp"
#include "runner/interrupt.hpp"
#include "small_runs.hpp"

namespace clothbench {
namespace {

using namespace std::chrono_literals;

class Hold : public SmallRuns {};

TEST_F(Hold, ATrialThatWasHeldIsRunAgainAndTheWaitIsNotTimed) {
  int steps = 0;
  std::thread release;
  const int in_trial = 4 + 3 + 10;  // accuracy pass, warm-up, then the tenth frame of the trial
  const SolverEntry entry = ballistic_with([&](ClothSolver& inner, const nlohmann::json&, const FrameInput& f) {
    if (++steps == in_trial) {
      hold_runs(true);
      release = std::thread([] {
        std::this_thread::sleep_for(300ms);
        hold_runs(false);
      });
    }
    return inner.step(f);
  });
  const auto start = std::chrono::steady_clock::now();
  const RunResult result = execute_runs(plan_of({{&scene_, &entry, nlohmann::json::object()}}, 1, 20), options_);
  EXPECT_GE(std::chrono::steady_clock::now() - start, 280ms) << "it did wait";
  ASSERT_TRUE(release.joinable());
  release.join();
  EXPECT_EQ(steps, 4 + 2 * (3 + 20)) << "one accuracy pass, two trials with their warm-ups";
  const RunRecord record = read_run(result.files.at(0));
  EXPECT_EQ(record.outcome.status, "ok");
  ASSERT_EQ(record.trials.size(), 1u);
  EXPECT_EQ(record.trials[0].frames(), 20);
  for (double w : record.trials[0].frame_wall_s) EXPECT_LT(w, 0.2);
  EXPECT_TRUE(record.summary.count("temperature_end_C") == 1 && record.summary.count("cpu_clock_start_Hz") == 1);
}

TEST_F(Hold, AnInterruptEndsAHeldRun) {
  hold_runs(true);
  request_interrupt();
  SolverRun run({&scene_, &find_solver("ballistic"), nlohmann::json::object(), "default"}, {}, "test");
  TrialRules rules;
  rules.accuracy_duration_s = 0.1;
  EXPECT_THROW(run.run_accuracy(rules), Error);
  clear_interrupt();
  hold_runs(false);
  EXPECT_NO_THROW(run.run_accuracy(rules));
}

}  // namespace
}  // namespace clothbench

// Runs of a small scene: paused within a trial (as if an Android activity were paused), in a settings sweep, resumed.
#include <algorithm>
#include <chrono>
#include <cstdlib>
#include <functional>
#include <memory>
#include <thread>
#include <utility>

#include "refusal.hpp"
#include "runner/interrupt.hpp"
#include "runner/study_plan.hpp"
#include "runner/study_runner.hpp"
#include "scenario/load.hpp"
#include "solvers.hpp"
#include "with_folder.hpp"

namespace clothbench {
namespace {

/// Steps `inner`, with the settings of the run.
using WrappedStep = std::function<StepStatus(ClothSolver& inner, const nlohmann::json& settings, const FrameInput&)>;

/// A solver with its step replaced.
class Wrapped final : public WrappedSolver {
 public:
  Wrapped(std::unique_ptr<ClothSolver> inner, nlohmann::json settings, WrappedStep step)
      : WrappedSolver(std::move(inner)), settings_(std::move(settings)), step_(std::move(step)) {}
  StepStatus step(const FrameInput& f) override { return step_(*inner_, settings_, f); }

 private:
  nlohmann::json settings_;
  WrappedStep step_;
};

/// The ballistic solver with its step replaced.
SolverEntry ballistic_with(const WrappedStep& step) {
  SolverEntry entry = find_solver("ballistic");
  entry.make = [make = entry.make, step](const nlohmann::json& settings, const DeviceOptions& device) {
    return std::make_unique<Wrapped>(make(nlohmann::json::object(), device), settings, step);
  };
  return entry;
}

/// Runs of a small scene in the test's own folder.
class SmallRuns : public WithFolder {
 protected:
  void SetUp() override { options_.out = dir_; }

  static RunPlan plan_of(std::vector<RunSpec> group, int trials, int frames, double accuracy_s = 0.05) {
    RunPlan plan;
    plan.protocol = "test";
    plan.rules.trials = trials;
    plan.rules.frames = frames;
    plan.rules.warmup_s = 0;
    plan.rules.accuracy_duration_s = accuracy_s;
    plan.groups = {std::move(group)};
    return plan;
  }

  const Scene scene_ = load_scene("paper/gravity", {"cloth.grid=[4,4]"});
  RunOptions options_;
};

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

TEST_F(SmallRuns, WindowsLastTheirTimeAtTheScenesRate) {
  const SolverEntry& ballistic = find_solver("ballistic");
  RunPlan plan = plan_of(
      {{&scene_, &ballistic, nlohmann::json::object()}, {&scene_, &ballistic, nlohmann::json::object(), "again"}}, 1,
      20);
  sustain(plan, 25);
  EXPECT_EQ(plan.groups.size(), 2u) << "one run after the other";
  EXPECT_EQ(plan.rules.trials, 3);
  EXPECT_EQ(plan.rules.window_s, 25.0 / 3);
  plan.rules.window_s = 0.1;
  const RunRecord r = read_run(execute_runs(plan, options_).files.at(0));
  ASSERT_EQ(r.trials.size(), 3u);
  EXPECT_EQ(r.header.environment.at("window_s"), 0.1);
  const double rate_hz = scene_.time.frame_rate_hz;
  for (const TimedTrial& t : r.trials) {
    EXPECT_EQ(t.frames(), std::lround(0.1 * rate_hz));
    EXPECT_GT(t.end_unix_s - t.start_unix_s, 0.09 - 1 / rate_hz);
    EXPECT_LT(*std::min_element(t.frame_wall_s.begin(), t.frame_wall_s.end()), 0.5 / rate_hz) << "without the pauses";
  }
  EXPECT_NO_THROW(require_same_runs(options_.out, plan, true));
  plan.rules.window_s = 0.2;
  EXPECT_TRUE(mentions(refusal([&] { require_same_runs(options_.out, plan, true); }), "windows of 0.1 s"));
}

// Settings sweeps: where they end, and what is stored for the remaining settings; and trials that agree.

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
  plan.rules.agree = 0.5;  // a sleep never differs that much by itself
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
  EXPECT_TRUE(std::isnan(runs.at("substeps=10").trials[0].pipelined_wall_s)) << "not asked for";
}

// A folder is continued only if its runs have the same scene, settings and solver version.

namespace fs = std::filesystem;

class Resume : public SmallRuns {
 protected:
  void SetUp() override {
    SmallRuns::SetUp();
    options_.resume = true;
    entry_.info.settings = {{"substeps", "4", "of a test"}};
  }

  RunPlan plan(const Scene& scene, int substeps = 4) const {
    return plan_of({{&scene, &entry_, {{"substeps", substeps}}}}, 1, 2);
  }
  /// The Error that refuses to continue, both before anything is written and in the run itself.
  std::string refused(const RunPlan& p) const {
    const std::string looked = refusal([&] { require_same_runs(options_.out, p, true); }, ExitCode::BadInput);
    EXPECT_EQ(refusal([&] { execute_runs(p, options_); }), looked);
    return looked;
  }

  SolverEntry entry_ =
      ballistic_with([](ClothSolver& inner, const nlohmann::json&, const FrameInput& f) { return inner.step(f); });
  const Scene edited_ = load_scene("paper/gravity", {"cloth.grid=[4,5]"});
};

TEST_F(Resume, ARunThatWasOnlyBegunIsLookedAtToo) {
  const SolverRun run(plan(scene_).groups[0][0], {}, "test");
  const RunWriter begun(options_.out, run.header());
  require_same_runs(options_.out, plan(scene_), false);
  EXPECT_THROW(require_same_runs(options_.out, plan(edited_), false), Error);
  EXPECT_THROW(require_same_runs(options_.out, plan(edited_), true), Error);
}

TEST_F(Resume, OtherSettingsAndVersionsAreRefusedAndDefaultsAreFilledIn) {
  execute_runs(plan(scene_), options_);
  EXPECT_EQ(refused(plan(scene_)), "");
  EXPECT_THROW(require_same_runs(options_.out, plan(scene_), false), Error) << "finished, and not resumed";
  EXPECT_NE(refused(plan(scene_, 5)).find("\"substeps\":5"), std::string::npos);
  const RunPlan by_default = plan_of({{&scene_, &entry_, nlohmann::json::object()}}, 1, 2);
  EXPECT_EQ(refused(by_default), "");
  const std::string version = std::exchange(entry_.info.version, "next");
  EXPECT_NE(refused(plan(scene_)).find("next"), std::string::npos);
  entry_.info.version = version;
  entry_.make = nullptr;  // as for a solver that this process does not have
  require_same_runs(options_.out, by_default, true);
  EXPECT_THROW(require_same_runs(options_.out, plan(scene_, 5), true), Error);
}

/// A plan with trials continues from earlier untimed passes, also from passes that ended badly.
TEST_F(Resume, UntimedPassesAreNotRepeated) {
  int steps = 0;
  const SolverEntry entry = ballistic_with([&](ClothSolver& inner, const nlohmann::json& s, const FrameInput& f) {
    ++steps;
    const StepStatus status = inner.step(f);
    return s["substeps"] == 8 ? StepStatus::NotFinite : status;
  });
  RunPlan p =
      plan_of({{&scene_, &entry, {{"substeps", 4}}, "good"}, {&scene_, &entry, {{"substeps", 8}}, "bad"}}, 1, 2);
  options_.out = dir_ / "serial";
  const RunResult serial = execute_runs(p, options_);
  const int serial_steps = std::exchange(steps, 0);
  options_.out = dir_ / "apart";
  p.untimed = true;
  setenv("CLOTHBENCH_JOBS", "8", 1);
  EXPECT_TRUE(execute_runs(p, options_).files.empty());
  setenv("CLOTHBENCH_JOBS", "1", 1);
  const int untimed_steps = std::exchange(steps, 0);
  p.untimed = false;
  const RunResult timed = execute_runs(p, options_);
  EXPECT_GT(steps, 0);
  EXPECT_EQ(untimed_steps + steps, serial_steps);
  ASSERT_EQ(timed.files.size(), serial.files.size());
  for (std::size_t k = 0; k < timed.files.size(); ++k) {
    const RunRecord a = read_run(serial.files[k]), b = read_run(timed.files[k]);
    EXPECT_EQ(a.outcome.status, b.outcome.status);
    EXPECT_EQ(a.outcome.failed_frame, b.outcome.failed_frame);
    EXPECT_EQ(a.outcome.trajectory_sha256, b.outcome.trajectory_sha256);
    EXPECT_EQ(a.trials.size(), b.trials.size());
    EXPECT_EQ(jobs_of(b), 1) << "other jobs during the untimed pass do not affect trials";
  }
  unsetenv("CLOTHBENCH_JOBS");
}

}  // namespace
}  // namespace clothbench

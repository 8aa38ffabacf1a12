// A run whose process fails becomes a row with its reason, and the study continues.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <chrono>
#include <cstdlib>
#include <deque>
#include <filesystem>
#include <set>

#include "results/store.hpp"
#include "runner/study_plan.hpp"
#include "runner/study_runner.hpp"
#include "scenario/load.hpp"
#include "scenario/study.hpp"
#include "with_folder.hpp"

namespace clothbench {
namespace {

namespace fs = std::filesystem;

const nlohmann::json kScenario =
    nlohmann::json::parse(R"({"name": "fall", "why": "falls in a test", "cloth": {"grid": [3, 3], "size_m": [1, 1],
      "areal_density_kg_per_m2": 0.2, "sides": "single"}, "material": {"membrane_stiffness_N_per_m": 1000},
      "time": {"frame_rate_hz": 60, "duration_s": 0.5}, "stability": {"case": "S02", "judged": ["F0", "F1", "F2"]}})");

class Process : public WithFolder {
 protected:
  RunRecord run(const std::string& solver, double limit_s = 0) {
    if (!worker_) worker_ = std::make_unique<Worker>(FAULTY_CHILD, dir_ / "scratch");
    Scene scene = scene_;
    scene.name = fmt::format("fall-{}-{}", solver, ++runs_);
    SolverEntry entry;
    entry.info.name = solver;
    RunPlan plan;
    plan.protocol = "quick";
    plan.rules.trials = 0;
    plan.rules.run_limit_s = limit_s;
    RunOptions options;
    options.out = dir_;
    return run_apart(*worker_, plan, {&scene, &entry, nlohmann::json::object(), "default"}, options);
  }
  /// Trials of these solvers in one group.
  RunPlan timed(const std::vector<std::string>& names, int trials, double accuracy_s) {
    RunPlan plan;
    plan.groups.emplace_back();
    plan.rules = {.trials = trials, .frames = 6, .warmup_s = 0, .drop_frames = 0, .accuracy_duration_s = accuracy_s};
    for (const std::string& name : names) {
      solvers_.emplace_back().info.name = name;
      plan.groups[0].push_back({&scene_, &solvers_.back(), nlohmann::json::object(), "default"});
    }
    return plan;
  }
  const Scene scene_ = scene_from_json(kScenario, "test");
  std::deque<SolverEntry> solvers_;
  std::unique_ptr<Worker> worker_;
  int runs_ = 0;
};

/// All solvers of a timed group share one process, and one of them ends it.
TEST_F(Process, ATimedStudyGoesOnAfterEveryFault) {
  const char* const kLimit = "CLOTHBENCH_SOLVER_LIMIT_S";
  setenv(kLimit, "4", 1);
  const RunPlan plan = timed({"crashes", "falls", "hangs", "loses-device"}, 2, 0);
  RunOptions options;
  options.out = dir_;
  options.program = FAULTY_CHILD;
  execute_in_worker(plan, options);
  unsetenv(kLimit);
  const auto stored = [&](const std::string& solver) {
    return read_run(finished_file(dir_, "fall__" + solver + "__default"));
  };
  const RunRecord crashed = stored("crashes"), hung = stored("hangs"), fell = stored("falls");
  EXPECT_EQ(crashed.outcome.status, "crashed");
  EXPECT_NE(crashed.outcome.message.find("signal 11"), std::string::npos) << crashed.outcome.message;
  EXPECT_NE(crashed.outcome.message.find("trial 1 of 2"), std::string::npos) << crashed.outcome.message;
  EXPECT_EQ(hung.outcome.status, "timed_out") << hung.outcome.message;
  EXPECT_EQ(stored("loses-device").outcome.status, "device_lost");
  EXPECT_EQ(fell.outcome.status, "ok");
  EXPECT_EQ(fell.trials.size(), 2u);
  EXPECT_EQ(solver_faults({crashed, hung, fell, stored("loses-device")}).size(), 3u)
      << "one sentence per solver that finished none of its runs";
}

/// Parallel untimed passes give the same rows as sequential ones.
TEST_F(Process, UntimedPassesSideBySideChangeNoRow) {
  const RunPlan plan = timed({"falls", "crashes", "nan"}, 1, 0.5);
  RunOptions options;
  options.program = FAULTY_CHILD;
  for (const int jobs : {1, 3}) {
    options.out = dir_ / std::to_string(jobs);
    options.jobs = jobs;
    execute_in_worker(plan, options);
  }
  for (const std::string& name : run_names(plan)) {
    SCOPED_TRACE(name);
    const RunRecord a = read_run(finished_file(dir_ / "1", name)), b = read_run(finished_file(dir_ / "3", name));
    EXPECT_EQ(a.outcome.status, b.outcome.status);
    EXPECT_EQ(a.outcome.failed_frame, b.outcome.failed_frame);
    EXPECT_EQ(a.outcome.trajectory_sha256, b.outcome.trajectory_sha256);
    EXPECT_EQ(a.summary.at("trials"), b.summary.at("trials")) << "not taken from the untimed pass";
  }
}

TEST_F(Process, EveryEndIsARowWithItsReason) {
  const struct {
    const char *solver, *status, *klass, *message;
    int failed_frame, grade;
  } ends[] = {
      {"falls", "ok", "ok", "", -1, 0},
      {"crashes", "crashed", "F3", "signal 11", -1, 2},
      {"aborts", "crashed", "F3", "the assertion failed", -1, 2},
      {"exits", "crashed", "F3", "exit status 2", -1, 2},
      {"throws", "error", "F3", "thrown in a frame", -1, 2},
      {"refuses", "error", "F3", "no such cloth", -1, 2},
      {"no-memory", "error", "F3", "bad_alloc", -1, 2},
      {"loses-device", "device_lost", "F3", "the device was lost", 3, 2},
      {"nan", "not_finite", "F0", "", 3, 2},
  };
  for (const auto& end : ends) {
    SCOPED_TRACE(end.solver);
    const RunRecord a = run(end.solver);
    EXPECT_EQ(a.outcome.status, end.status);
    EXPECT_EQ(a.outcome.klass, end.klass);
    EXPECT_NE(a.outcome.message.find(end.message), std::string::npos) << a.outcome.message;
    EXPECT_EQ(a.outcome.failed_frame, end.failed_frame);
    EXPECT_EQ(a.summary.at("stability_grade"), end.grade);
  }
}

TEST_F(Process, AHangIsKilledAndTimedOutWithoutTheLastWordsOfAnotherRun) {
  EXPECT_EQ(run("says").outcome.status, "ok");
  const auto began = std::chrono::steady_clock::now();
  const RunRecord a = run("hangs", 0.5);
  EXPECT_EQ(a.outcome.status, "timed_out");
  EXPECT_EQ(a.outcome.klass, "F3");
  EXPECT_EQ(a.outcome.message.find("something else"), std::string::npos) << a.outcome.message;
  EXPECT_LT(std::chrono::steady_clock::now() - began, std::chrono::seconds(30));
}

TEST_F(Process, OneChildTakesManyRunsAndIsReplacedAfterAFault) {
  EXPECT_EQ(run("falls").outcome.status, "ok");
  EXPECT_EQ(run("nan").outcome.status, "not_finite");
  EXPECT_EQ(run("falls").outcome.status, "ok");
  EXPECT_EQ(worker_->children(), 1);
  EXPECT_EQ(run("loses-device").outcome.status, "device_lost");
  EXPECT_EQ(run("falls").outcome.status, "ok");
  EXPECT_EQ(worker_->children(), 2);
  // The crash must recur in a process that has run nothing else.
  EXPECT_EQ(run("crashes").outcome.status, "crashed");
  EXPECT_EQ(worker_->children(), 3);
  EXPECT_EQ(run("falls").outcome.status, "ok");
  EXPECT_EQ(worker_->children(), 4);
}

TEST(StabilityCases, AreAllThereAndLoad) {
  std::set<std::string> cases;
  for (const StudyLength length : {StudyLength::Quick, StudyLength::Full}) {
    const Study study = load_study("stability", {{}, length});
    for (const Study::Item& item : study.scenes) {
      EXPECT_FALSE(item.scene.stability.name.empty()) << item.scene.name;
      EXPECT_NE(item.scene.stability.judged & 1u, 0u) << item.scene.name << " does not judge F0";
      cases.insert(item.scene.stability.name);
      const std::string number = item.scene.name.substr(1, 2);
      EXPECT_EQ(item.scene.stability.name, "S" + number) << item.scene.name;
      // A separate process must read a scene with the same hash, which --resume compares.
      if (length == StudyLength::Quick) {
        EXPECT_EQ(scene_from_json(nlohmann::json::parse(item.scene.json), item.scene.source).sha256, item.scene.sha256)
            << item.scene.name;
      }
    }
  }
  EXPECT_EQ(cases.size(), 26u);
}

}  // namespace
}  // namespace clothbench

// Uneven frames (hitch or jitter of the scene's clock) reach the solver in every kind of run.
#include <gtest/gtest.h>

#include <algorithm>
#include <chrono>
#include <nlohmann/json.hpp>
#include <thread>

#include "refusal.hpp"
#include "runner/frame_loop.hpp"
#include "runner/reference.hpp"
#include "runner/study_runner.hpp"
#include "scenario/load.hpp"
#include "solvers.hpp"
#include "with_folder.hpp"

namespace clothbench {
namespace {

const std::string kHitch = R"(time.hitch={"frame":3,"dt_s":0.1})", kJitter = R"(time.jitter={"share":0.5})";

/// A solver whose cloth does not move, which records the frames that it is asked for.
class Spy final : public StillSolver {
 public:
  Spy(SolverInfo info, std::vector<FrameInput>& seen) : StillSolver(std::move(info)), seen_(seen) {}
  bool restart(const ClothState&) override { return true; }
  StepStatus step(const FrameInput& in) override {
    seen_.push_back(in);
    return StepStatus::Ok;
  }
  Plan plan() const override {
    return {{{"stand", scene_->needs, 0, kMissing, kMissing}}, {}, {{"threads", "none here", "sheet_Y"}, {"air", "-"}}};
  }

 private:
  std::vector<FrameInput>& seen_;
};

SolverEntry spy(std::vector<FrameInput>& seen) {
  SolverEntry e;
  e.info.name = "spy";
  e.info.supports = all_features();
  e.make = [info = e.info, &seen](const nlohmann::json&, const DeviceOptions&) {
    return std::make_unique<Spy>(info, seen);
  };
  e.free_fall_m = [](const Scene&, const nlohmann::json&, int) { return 0.0; };
  return e;
}

void expect_frames_of(const Scene& s, const std::vector<FrameInput>& seen) {
  ASSERT_FALSE(s.time.ends_s.empty());
  ASSERT_FALSE(seen.empty());
  for (const FrameInput& f : seen) {
    EXPECT_EQ(f.time_s, s.time.at(f.index + 1)) << "frame " << f.index;
    EXPECT_EQ(f.dt_s, s.time.dt_after(f.index)) << "frame " << f.index;
  }
}

TEST(FrameInput, IsTheScenesAndEvenBeyondItsEnd) {
  const Scene even = load_scene("conformance/sheet"), uneven = load_scene("conformance/sheet", {kHitch});
  const int last = even.time.frames() - 1;
  for (const int f : {0, 3, last, last + 5}) {
    EXPECT_EQ(frame_input(even, f).time_s, (f + 1) * even.time.dt());
    EXPECT_EQ(frame_input(even, f).dt_s, even.time.dt());
  }
  EXPECT_EQ(frame_input(uneven, 3).dt_s, 0.1);
  EXPECT_NEAR(frame_input(uneven, 3).time_s, 3 * even.time.dt() + 0.1, 1e-15);
  EXPECT_EQ(frame_input(uneven, last).time_s, uneven.time.ends_s.back());
  EXPECT_EQ(frame_input(uneven, last + 2).dt_s, even.time.dt());
  EXPECT_EQ(frame_input(uneven, last + 2).time_s, uneven.time.ends_s.back() + 2 * even.time.dt());
}

TEST(FrameLoop, BeginsTheSceneAnewWithEveryDropAndStopsWhereItShould) {
  const Scene s = load_scene("conformance/sheet");
  std::vector<FrameInput> seen;
  const auto indices = [&] {
    std::vector<int> out;
    for (const FrameInput& f : seen) out.push_back(f.index);
    seen.clear();
    return out;
  };
  const auto solver = load_solver(spy(seen), nlohmann::json::object(), {}, s);
  FrameLoop drops(*solver, s, {.frames = 5, .drop_frames = 2});
  while (drops.next()) {
  }
  EXPECT_EQ(indices(), (std::vector<int>{0, 1, 0, 1, 0}));
  EXPECT_EQ(drops.index(), 4);
  FrameLoop batches(*solver, s, {.frames = 5, .drop_frames = 2});
  EXPECT_TRUE(batches.next_drop());
  EXPECT_EQ(indices(), (std::vector<int>{0, 1}));
  EXPECT_TRUE(batches.next_drop() && batches.next_drop());
  EXPECT_EQ(batches.index(), 4) << "the first frame of the last drop";
  EXPECT_FALSE(batches.next_drop());
  EXPECT_EQ(indices(), (std::vector<int>{0, 1, 0}));
  FrameLoop timed(*solver, s, {.frames = 5, .max_wall_s = 1e-12, .min_frames = 3});
  while (timed.next()) {
  }
  EXPECT_EQ(indices(), (std::vector<int>{0, 1, 2}));
  FrameLoop fails(*solver, s, {.first = 2, .frames = 5});
  EXPECT_FALSE(fails.next([](const FrameInput&) { return StepStatus::Diverged; }));
  EXPECT_TRUE(fails.failed());
  EXPECT_FALSE(fails.next()) << "the loop ends after a failure";
  EXPECT_EQ(fails.index(), 2);
}

TEST(FrameLoop, WithAPeriodWaitsOutsideTheClockAndDoesNotHurryAfterALateFrame) {
  using Clock = std::chrono::steady_clock;
  constexpr double kPeriod_s = 0.03, kLate_s = 0.1;
  const Scene s = load_scene("conformance/sheet");
  const auto solver = load_solver(find_solver("ballistic"), nlohmann::json::object(), {}, s);
  std::vector<Clock::time_point> begun;
  double shortest_s = 1;
  FrameLoop loop(*solver, s, {.frames = 5, .period_s = kPeriod_s});
  while (loop.next([&](const FrameInput& f) {
    begun.push_back(Clock::now());
    if (f.index == 2) std::this_thread::sleep_for(std::chrono::duration<double>(kLate_s));
    return StepStatus::Ok;
  })) {
    shortest_s = std::min(shortest_s, loop.wall_s());
  }
  EXPECT_LT(shortest_s, kPeriod_s / 2);
  ASSERT_EQ(begun.size(), 5u);
  int frames = 0;
  FrameLoop ends(*solver, s, {.frames = 100, .end_after_s = 0.05});
  while (ends.next([&](const FrameInput&) {
    std::this_thread::sleep_for(std::chrono::milliseconds(30));
    ++frames;
    return StepStatus::Ok;
  })) {
  }
  EXPECT_TRUE(frames == 1 || frames == 2) << frames;
  const auto gap_s = [&](std::size_t k) { return std::chrono::duration<double>(begun[k] - begun[k - 1]).count(); };
  // A frame that wakes up late shortens the next gap.
  EXPECT_GT(gap_s(1) + gap_s(2), 1.5 * kPeriod_s);
  EXPECT_GE(gap_s(3), kLate_s);
  EXPECT_GT(gap_s(4), 0.5 * kPeriod_s);
}

TEST(UnevenFrames, ReachTheSolverInAWholeRun) {
  for (const std::string& how : {kHitch, kJitter}) {
    const Scene s = load_scene("validation/incline-stick", {how, "time.duration_s=0.25"});
    std::vector<FrameInput> seen;
    const SolverEntry entry = spy(seen);
    SolverRun run({&s, &entry, nlohmann::json::object()}, {}, "test");
    whole_pass(run, s);
    EXPECT_EQ(seen.size(), static_cast<std::size_t>(s.time.frames()));
    expect_frames_of(s, seen);
  }
}

TEST(UnevenFrames, ReachTheReference) {
  for (const SolverEntry& e : solvers())
    if (e.info.name == "reference") {
      const ReferenceResult r = compute_reference(load_scene("validation/pendulum", {kHitch, "time.duration_s=0.25"}));
      EXPECT_LE(r.truth_distance, 1e-3) << r.value << " against " << r.truth;
      return;
    }
  GTEST_SKIP() << "no solver reference in this build";
}

// A failed or impossible run must not count as a good one.

const nlohmann::json kNone = nlohmann::json::object();

TEST(Record, HasWhatIsNoParameterOfTheRun) {
  const Scene scene = load_scene("conformance/sheet");
  std::vector<FrameInput> seen;
  const SolverEntry entry = spy(seen);
  const SolverRun run({&scene, &entry, kNone, "default"}, {}, "run");
  const nlohmann::json& left_out = run.header().plan.at("left_out");
  EXPECT_EQ(left_out[0], (nlohmann::json{{"what", "threads"}, {"why", "none here"}, {"no_parameter", "sheet_Y"}}));
  EXPECT_FALSE(left_out[1].contains("no_parameter"));
}

TEST(RequireSameRuns, RefusesTwoRunsOfOneFile) {
  const ScratchFolder folder;
  const Scene scene = load_scene("conformance/sheet");
  std::vector<FrameInput> seen;
  const SolverEntry entry = spy(seen);
  const RunSpec run{&scene, &entry, kNone, "default"};
  for (const auto& groups : {std::vector<std::vector<RunSpec>>{{run, run}}, {{run}, {run}}}) {
    RunPlan plan;
    plan.groups = groups;
    EXPECT_PRED2(mentions, refusal([&] { require_same_runs(folder.path(), plan, false); }),
                 "conformance-sheet__spy__default");
  }
}

// The rule of exit codes: a solver that finished none of its runs is a fault, however they ended.

std::vector<std::string> faults(const std::vector<std::pair<std::string, std::string>>& ends) {
  std::vector<RunRecord> runs;
  for (const auto& [solver, status] : ends) {
    runs.emplace_back().header.solver = solver;
    runs.back().outcome = {status, "F3", 3, "why"};
  }
  return solver_faults(runs);
}

TEST(SolverEnds, EveryKindOfFailureCountsAlike) {
  for (const char* status : {"crashed", "timed_out", "diverged", "not_finite", "device_lost", "error"}) {
    EXPECT_EQ(faults({{"mine", status}}),
              std::vector<std::string>{std::string("mine: finished none of 1 runs; the last: ") + status + ": why"});
    EXPECT_TRUE(faults({{"mine", status}, {"mine", "ok"}}).empty()) << status;
    EXPECT_EQ(faults({{"mine", status}, {"other", "ok"}}).size(), 1u) << "each solver counts separately: " << status;
    EXPECT_EQ(faults({{"mine", status}, {"mine", "unsupported"}}).size(), 1u) << status;
  }
}

TEST(SolverEnds, NoRunAndAnEndThatTheSceneExpectsAreNoFailures) {
  EXPECT_TRUE(faults({{"mine", "unsupported"}, {"mine", "over_budget"}}).empty());
  EXPECT_TRUE(faults({}).empty());
  std::vector<RunRecord> runs(1);
  runs[0].outcome = {"diverged", "F0", 3, "why", "pass"};
  EXPECT_TRUE(solver_faults(runs).empty());
  runs[0].outcome.expect = "fail: outcome";
  EXPECT_EQ(solver_faults(runs).size(), 1u);
}

}  // namespace
}  // namespace clothbench

// The rule of exit codes: a solver that finished none of its runs is a fault, however they ended.
#include <gtest/gtest.h>

#include "runner/study_runner.hpp"

namespace clothbench {
namespace {

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
    EXPECT_EQ(faults({{"mine", status}, {"other", "ok"}}).size(), 1u) << "of each solver by itself: " << status;
    EXPECT_EQ(faults({{"mine", status}, {"mine", "unsupported"}}).size(), 1u) << status;
  }
}

TEST(SolverEnds, WhatWasNotRunIsNoFailure) {
  EXPECT_TRUE(faults({{"mine", "unsupported"}, {"mine", "over_budget"}}).empty());
  EXPECT_TRUE(faults({}).empty());
}

TEST(SolverEnds, AnEndThatTheSceneExpectsIsNoFailure) {
  std::vector<RunRecord> runs(1);
  runs[0].outcome = {"diverged", "F0", 3, "why", "pass"};
  EXPECT_TRUE(solver_faults(runs).empty());
  runs[0].outcome.expect = "fail: outcome";
  EXPECT_EQ(solver_faults(runs).size(), 1u);
}

}  // namespace
}  // namespace clothbench

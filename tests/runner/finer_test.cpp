// Rows "x16" of the penetration study take 16 times the substeps that their solvers take by themselves. Those of `xpbd`
// depend on the scene: tests/pbd-gpu/finer_test.cpp.
#include <gtest/gtest.h>

#include <algorithm>
#include <set>

#include "clothbench/solver.hpp"
#include "scenario/study.hpp"

namespace clothbench {
namespace {

constexpr int kTimes = 16, kFrames = 2;

std::vector<double> after_some_frames(const SolverEntry& entry, const nlohmann::json& settings, const Scene& scene) {
  const auto solver = entry.make(complete_settings(entry.info, settings), {});
  solver->load(scene);
  const double dt = scene.time.dt();
  for (int f = 0; f < kFrames; ++f)
    EXPECT_EQ(solver->step({f, (f + 1) * dt, dt, scene.motion_after(f)}), StepStatus::Ok);
  ClothState state;
  solver->read_state(state);
  return state.position;
}

TEST(FinerRows, TakeSixteenTimesTheSubsteps) {
  const Study study = load_study("penetration", {{}, StudyLength::Full});
  std::set<std::size_t> seen;
  for (const Study::Item& item : study.scenes)
    for (const std::size_t k : item.solvers) {
      const StudySolver& s = study.solvers[k];
      if (s.label != "x16" || s.solver == "xpbd") continue;
      EXPECT_FALSE(s.timed) << item.scene.name;
      if (!seen.insert(k).second) continue;
      const auto& all = solvers();
      const auto entry =
          std::find_if(all.begin(), all.end(), [&](const SolverEntry& e) { return e.info.name == s.solver && e.make; });
      if (entry == all.end()) continue;
      const int substeps = s.settings.at("substeps").get<int>(),
                own = complete_settings(entry->info, nlohmann::json::object()).at("substeps").get<int>();
      ASSERT_EQ(substeps % kTimes, 0) << s.name();
      if (own > 0) {
        EXPECT_EQ(substeps, kTimes * own) << s.name();
        continue;
      }
      // The solver chooses; the bits of the result show which number.
      const auto by_itself = after_some_frames(*entry, nlohmann::json::object(), item.scene);
      EXPECT_EQ(by_itself, after_some_frames(*entry, {{"substeps", substeps / kTimes}}, item.scene))
          << s.name() << ": its own rule gives another number now";
      EXPECT_NE(by_itself, after_some_frames(*entry, {{"substeps", substeps / kTimes + 1}}, item.scene)) << s.name();
    }
  EXPECT_EQ(seen.size(), 3u);
}

}  // namespace
}  // namespace clothbench

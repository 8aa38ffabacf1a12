// Rows "x16" of the penetration study: 16 times the substeps that `xpbd` takes by itself, which depend on the
// collider's speed. (Those of the other solvers: tests/runner/finer_test.cpp.)
#include <gtest/gtest.h>

#include "clothbench/solver.hpp"
#include "line_plan.hpp"
#include "scenario/study.hpp"
#include "substeps.hpp"

namespace clothbench {
namespace {

TEST(FinerRows, TakeSixteenTimesTheSubstepsOfXpbd) {
  const Study study = load_study("penetration", {{}, StudyLength::Full});
  const SolverEntry& xpbd = find_solver("xpbd");
  int rows = 0;
  for (const Study::Item& item : study.scenes)
    for (const std::size_t k : item.solvers) {
      const StudySolver& s = study.solvers[k];
      if (s.label != "x16" || s.solver != "xpbd") continue;
      ++rows;
      EXPECT_FALSE(s.timed) << item.scene.name;
      EXPECT_EQ(s.settings.at("substeps").get<int>(),
                16 * pbd_gpu::xpbd_substeps(item.scene, complete_settings(xpbd.info, nlohmann::json::object())))
          << item.scene.name;
    }
  EXPECT_EQ(rows, 2 * 7);
}

}  // namespace
}  // namespace clothbench

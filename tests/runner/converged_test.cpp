// Converged solutions: the mean of nudged starts, their spread, and the error of runs against the mean.
#include <gtest/gtest.h>

#include <cmath>

#include "runner/reference.hpp"
#include "runner/study_runner.hpp"
#include "scenario/load.hpp"
#include "with_folder.hpp"

namespace clothbench {
namespace {

using nlohmann::json;
namespace fs = std::filesystem;

class Ensembles : public WithFolder {
 protected:
  static Scene scene(const std::string& name, const char* truth) {
    return load_scene(name, {"cloth.grid=[5,5]", "time.duration_s=0.1", std::string("truth.converged=") + truth});
  }
};

/// A free fall has no chaos: its spread is the nudge's, uniform within 1 mm along three axes.
TEST_F(Ensembles, MeasuresAPlantedErrorAndTheNudge) {
  const Scene s = scene("paper/gravity", R"({"substeps":4,"starts":200,"nudge_m":0.001})");
  const SolverEntry& ballistic = find_solver("ballistic");
  const Ensemble e = ensemble_of(s, ballistic, json::object(), {});
  const double longer_m = std::max(s.cloth.width_m, s.cloth.height_m);
  EXPECT_NEAR(longer_m * e.spread, 0.001, 0.0001);
  SolverRun run({&s, &ballistic, json::object()}, {}, "test");
  AccuracyPass pass = run.run_accuracy({});
  EXPECT_LT(longer_m * converged_error(s, pass, e.mean), 3 * 0.001 / std::sqrt(200));
  for (std::size_t k = 1; k < pass.position.size(); k += 3) pass.position[k] += 0.1F;
  EXPECT_NEAR(longer_m * converged_error(s, pass, e.mean), 0.1, 0.001);
  pass.position.pop_back();
  EXPECT_TRUE(std::isnan(converged_error(s, pass, e.mean))) << "a pass that ended early";
}

TEST_F(Ensembles, IsStoredWithEveryRunAndComputedOnce) {
  const Scene s = scene("validation/hang", R"({"substeps":8,"starts":2,"nudge_m":1e-5,"fine_grid":[9,9]})");
  const SolverEntry& xpbd = find_solver("xpbd");
  const auto spec = [&](int substeps) {
    return RunSpec{&s, &xpbd, complete_settings(xpbd.info, {{"substeps", substeps}}), std::to_string(substeps)};
  };
  RunPlan plan;
  plan.references = true;
  plan.rules.trials = 0;
  Scene layered = s;
  layered.needs.add(Feature::DuplicatedLayer);  // xpbd has none, but another solver's run is compared all the same
  layered.sha256 = "another";
  plan.groups = {{spec(8), spec(1), {&layered, &find_solver("ballistic"), json::object()}}};
  std::vector<std::map<std::string, double>> found;
  RunOptions options;
  options.out = dir_ / "out";
  options.reference_cache = dir_ / "cache";
  for (const auto& file : execute_runs(plan, options).files) found.push_back(read_run_summary(file).summary);
  ASSERT_EQ(found.size(), 3u);
  EXPECT_GT(found[2].at("truth_error"), 0.001) << "a free fall, not a hanging cloth";
  const double nudge = 1e-5 / s.cloth.width_m;
  EXPECT_LT(found[0].at("truth_error"), 2 * nudge) << "against itself, up to the nudge";
  EXPECT_GT(found[1].at("truth_error"), 10 * found[0].at("truth_error"));
  EXPECT_GT(found[0].at("truth_space_error"), 0);
  for (const auto& summary : found) {
    EXPECT_LE(summary.at("reference_spread"), 3 * nudge);
    EXPECT_GE(summary.at("reference_uncertainty"), summary.at("reference_spread"));
    EXPECT_GT(summary.at("reference_order_xpbd"), 0.5);
  }
  const auto again = references({&s}, dir_ / "cache", [](const std::string& what) { ADD_FAILURE() << what; });
  EXPECT_EQ(again.at(s.sha256).uncertainty, found[0].at("reference_uncertainty"));
  EXPECT_EQ(again.at(s.sha256).mean->size(), 8u * 3 * 33 * 33);
}

}  // namespace
}  // namespace clothbench

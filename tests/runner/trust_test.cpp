// What a failed or impossible run must not pass for.
#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <limits>
#include <nlohmann/json.hpp>

#include "../scenario/scratch_folder.hpp"
#include "clothbench/error.hpp"
#include "clothbench/record.hpp"
#include "runner/effective_moduli.hpp"
#include "runner/metamorphic.hpp"
#include "runner/solver_run.hpp"
#include "runner/study_runner.hpp"
#include "runner/threshold.hpp"
#include "scenario/load.hpp"

namespace clothbench {
namespace {

/// The fate of a cloth at rest, in a scene that was loaded.
using Fate = std::function<StepStatus(const Scene&, ClothState&)>;

class Doomed final : public ClothSolver {
 public:
  Doomed(SolverInfo info, Fate fate) : info_(std::move(info)), fate_(std::move(fate)) {}
  const SolverInfo& info() const override { return info_; }
  DeviceInfo device() const override { return {}; }
  void load(const Scene& s) override {
    scene_ = &s;
    reset();
  }
  void reset() override {
    state_ = {initial_positions(*scene_), std::vector<double>(3 * scene_->cloth.vertex_count(), 0)};
  }
  StepStatus step(const FrameInput&) override { return fate_(*scene_, state_); }
  void read_state(ClothState& out) const override { out = state_; }
  FrameCost last_cost() const override { return {kMissing, {kMissing}, {kMissing}, {kMissing}}; }
  Plan plan() const override {
    return {{{"stand", scene_->needs, 0, kMissing, kMissing}}, {}, {{"threads", "none here", "sheet_Y"}, {"air", "-"}}};
  }

 private:
  SolverInfo info_;
  Fate fate_;
  const Scene* scene_ = nullptr;
  ClothState state_;
};

SolverEntry doomed(const Fate& fate) {
  SolverEntry e;
  e.info.name = "doomed";
  e.info.precision = "float64";
  for (std::size_t i = 0; i < kFeatureCount; ++i) e.info.supports.add(static_cast<Feature>(i));
  e.make = [info = e.info, fate](const nlohmann::json&, const DeviceOptions&) {
    return std::make_unique<Doomed>(info, fate);
  };
  e.free_fall_m = [](const Scene&, const nlohmann::json&, int) { return 0.0; };
  return e;
}

const nlohmann::json kNone = nlohmann::json::object();
constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();

TEST(Record, HasWhatIsNoParameterOfTheRun) {
  const Scene scene = load_scene("metamorphic/sheet");
  const SolverEntry entry = doomed([](const Scene&, ClothState&) { return StepStatus::Ok; });
  const SolverRun run({&scene, &entry, kNone, "default"}, {}, "run");
  const nlohmann::json& left_out = run.header().plan.at("left_out");
  EXPECT_EQ(left_out[0], (nlohmann::json{{"what", "threads"}, {"why", "none here"}, {"no_parameter", "sheet_Y"}}));
  EXPECT_FALSE(left_out[1].contains("no_parameter"));
}

TEST(Metamorphic, ANanAtOneVertexIsNotLostAmongTheOthers) {
  // Wherever the scene has a collider the first vertex is nowhere; all others are right.
  const SolverEntry entry = doomed([](const Scene& s, ClothState& state) {
    if (!s.colliders.empty()) state.position[0] = kNaN;
    return StepStatus::Ok;
  });
  for (const MetamorphicResult& r : run_metamorphic(entry, kNone, {}, {load_scene("metamorphic/sheet")}))
    if (r.property == "no-op") {
      EXPECT_EQ(r.status, "fail");
      EXPECT_TRUE(std::isnan(r.distance)) << r.distance;
    }
}

TEST(Threshold, ARunThatFailsIsNoSlip) {
  const Scene s = load_scene("validation/incline-stick", {"time.duration_s=0.1"});
  for (const Fate& fate :
       {Fate([](const Scene&, ClothState&) { return StepStatus::Diverged; }), Fate([](const Scene&, ClothState& state) {
          state.position[0] = kNaN;
          return StepStatus::Ok;
        })}) {
    const FoundThreshold t = find_threshold(s, doomed(fate), kNone, {});
    EXPECT_TRUE(t.failed);
    EXPECT_FALSE(t.slips_at_most || t.holds_at_least);
    EXPECT_TRUE(std::isnan(t.found) && std::isnan(t.error));
    EXPECT_EQ(t.runs, 1) << "one failure is enough";
  }
  const FoundThreshold stands =
      find_threshold(s, doomed([](const Scene&, ClothState&) { return StepStatus::Ok; }), kNone, {});
  EXPECT_TRUE(stands.holds_at_least && !stands.failed);
}

TEST(Threshold, AStripThatRanOffItsCylinderSlipped) {
  const Scene s = load_scene("validation/capstan-hold", {"time.duration_s=0.1"});
  const FoundThreshold t = find_threshold(s, doomed([](const Scene& scene, ClothState& state) {
                                            for (std::size_t v = 0; v < scene.cloth.vertex_count(); ++v)
                                              for (std::size_t k = 0; k < 3; ++k)
                                                state.position[3 * v + k] +=
                                                    scene.cloth.axis_u[k] * scene.cloth.width_m;
                                            return StepStatus::Ok;
                                          }),
                                          kNone, {});
  EXPECT_FALSE(t.failed);
  EXPECT_TRUE(t.slips_at_most);
}

TEST(EffectiveModuli, OfNothingMeasuredIsNotAtRest) {
  const SolverEntry entry = doomed([](const Scene&, ClothState&) { return StepStatus::Diverged; });
  const RunRecord measured = measure_material(entry, kNone, "default", false, {}, "test");
  EXPECT_TRUE(std::isnan(measured.summary.at("material_unrest"))) << measured.summary.at("material_unrest");
  EXPECT_NE(measured.outcome.message.find("failed in frame 1"), std::string::npos);
}

TEST(ExecuteRuns, RefusesTwoRunsOfOneFile) {
  const ScratchFolder folder;
  const Scene scene = load_scene("metamorphic/sheet");
  const SolverEntry entry = doomed([](const Scene&, ClothState&) { return StepStatus::Ok; });
  const RunSpec run{&scene, &entry, kNone, "default"};
  RunOptions options;
  options.out = folder.path();
  for (const auto& groups : {std::vector<std::vector<RunSpec>>{{run, run}}, {{run}, {run}}}) {
    RunPlan plan;
    plan.groups = groups;
    plan.rules.trials = 1;
    plan.rules.frames = 1;
    plan.rules.warmup_s = 0;
    plan.protocol = "test";
    try {
      execute_runs(plan, options);
      ADD_FAILURE() << "nothing was refused";
    } catch (const Error& e) {
      EXPECT_NE(std::string(e.what()).find("metamorphic-sheet__doomed__default"), std::string::npos) << e.what();
    }
    EXPECT_TRUE(std::filesystem::is_empty(folder.path())) << "nothing was run before it was refused";
  }
}

}  // namespace
}  // namespace clothbench

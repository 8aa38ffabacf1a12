// A failed or impossible run must not pass for a good one.
#include <gtest/gtest.h>

#include <functional>
#include <nlohmann/json.hpp>

#include "../scenario/scratch_folder.hpp"
#include "clothbench/error.hpp"
#include "clothbench/record.hpp"
#include "runner/solver_run.hpp"
#include "runner/study_runner.hpp"
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

TEST(Record, HasWhatIsNoParameterOfTheRun) {
  const Scene scene = load_scene("conformance/sheet");
  const SolverEntry entry = doomed([](const Scene&, ClothState&) { return StepStatus::Ok; });
  const SolverRun run({&scene, &entry, kNone, "default"}, {}, "run");
  const nlohmann::json& left_out = run.header().plan.at("left_out");
  EXPECT_EQ(left_out[0], (nlohmann::json{{"what", "threads"}, {"why", "none here"}, {"no_parameter", "sheet_Y"}}));
  EXPECT_FALSE(left_out[1].contains("no_parameter"));
}

TEST(RequireSameRuns, RefusesTwoRunsOfOneFile) {
  const ScratchFolder folder;
  const Scene scene = load_scene("conformance/sheet");
  const SolverEntry entry = doomed([](const Scene&, ClothState&) { return StepStatus::Ok; });
  const RunSpec run{&scene, &entry, kNone, "default"};
  for (const auto& groups : {std::vector<std::vector<RunSpec>>{{run, run}}, {{run}, {run}}}) {
    RunPlan plan;
    plan.groups = groups;
    try {
      require_same_runs(folder.path(), plan, false);
      ADD_FAILURE() << "nothing was refused";
    } catch (const Error& e) {
      EXPECT_NE(std::string(e.what()).find("conformance-sheet__doomed__default"), std::string::npos) << e.what();
    }
  }
}

}  // namespace
}  // namespace clothbench

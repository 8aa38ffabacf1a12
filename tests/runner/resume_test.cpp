// A folder is gone on with only if what it holds is of the same scene, settings and version of the solver.
#include "clothbench/error.hpp"
#include "small_runs.hpp"

namespace clothbench {
namespace {

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
  /// Error that refuses to continue, before anything is written and in the run itself.
  std::string refusal(const RunPlan& p) const {
    std::string looked = "no error";
    try {
      require_same_runs(options_.out, p, true);
    } catch (const Error& e) {
      EXPECT_EQ(e.code(), ExitCode::BadInput);
      looked = e.what();
    }
    try {
      execute_runs(p, options_);
      EXPECT_EQ(looked, "no error") << "the run did not refuse";
    } catch (const Error& e) {
      EXPECT_EQ(looked, e.what());
    }
    return looked;
  }

  SolverEntry entry_ =
      ballistic_with([](ClothSolver& inner, const nlohmann::json&, const FrameInput& f) { return inner.step(f); });
  const Scene edited_ = load_scene("paper/gravity", {"cloth.grid=[4,5]"});
};

TEST_F(Resume, TheSameIsGoneOnWith) {
  execute_runs(plan(scene_), options_);
  EXPECT_EQ(refusal(plan(scene_)), "no error");
}

TEST_F(Resume, AnotherSceneOfTheSameNameIsRefused) {
  const fs::path file = execute_runs(plan(scene_), options_).files.at(0);
  const std::string text = refusal(plan(edited_));
  EXPECT_NE(text.find(file.string()), std::string::npos) << text;
  EXPECT_NE(text.find(scene_.sha256.substr(0, 12)), std::string::npos) << text;
  EXPECT_NE(text.find(edited_.sha256.substr(0, 12)), std::string::npos) << text;
  EXPECT_NE(text.find("--out"), std::string::npos) << text;
}

TEST_F(Resume, ARunThatWasOnlyBegunIsLookedAtToo) {
  const SolverRun run(plan(scene_).groups[0][0], {}, "test");
  const RunWriter begun(options_.out, run.header());
  require_same_runs(options_.out, plan(scene_), false);
  EXPECT_THROW(require_same_runs(options_.out, plan(edited_), false), Error);
  EXPECT_THROW(require_same_runs(options_.out, plan(edited_), true), Error);
}

TEST_F(Resume, OtherSettingsAreRefusedAndDefaultsAreFilledIn) {
  execute_runs(plan(scene_), options_);
  EXPECT_NE(refusal(plan(scene_, 5)).find("\"substeps\":5"), std::string::npos);
  EXPECT_EQ(refusal(plan_of({{&scene_, &entry_, nlohmann::json::object()}}, 1, 2)), "no error");
  entry_.make = nullptr;  // of a solver that this process does not have
  require_same_runs(options_.out, plan_of({{&scene_, &entry_, nlohmann::json::object()}}, 1, 2), true);
  EXPECT_THROW(require_same_runs(options_.out, plan(scene_, 5), true), Error);
}

TEST_F(Resume, AnotherVersionOfTheSolverIsRefused) {
  execute_runs(plan(scene_), options_);
  entry_.info.version += "-next";
  EXPECT_NE(refusal(plan(scene_)).find("-next"), std::string::npos);
}

TEST_F(Resume, WithoutItWhatIsFinishedIsRefused) {
  execute_runs(plan(scene_), options_);
  EXPECT_THROW(require_same_runs(options_.out, plan(scene_), false), Error);
}

}  // namespace
}  // namespace clothbench

// A folder is gone on with only if what it holds is of the same scene, settings and version of the solver.
#include "runner/resume.hpp"

#include <gtest/gtest.h>
#include <unistd.h>

#include <filesystem>

#include "clothbench/error.hpp"
#include "runner/study_runner.hpp"
#include "scenario/load.hpp"

namespace clothbench {
namespace {

namespace fs = std::filesystem;

class Resume : public ::testing::Test {
 protected:
  void SetUp() override {
    options_.out = fs::temp_directory_path() / ("clothbench-resume-" + std::to_string(getpid()) +
                                                ::testing::UnitTest::GetInstance()->current_test_info()->name());
    options_.resume = true;
    fs::create_directories(options_.out);
    entry_.info.settings = {{"substeps", "4", "of a test"}};
  }
  void TearDown() override { fs::remove_all(options_.out); }

  CellPlan plan(const Scene& scene, int substeps = 4) const {
    CellPlan p;
    p.protocol = "test";
    p.rules.trials = 1;
    p.rules.frames = 2;
    p.rules.warmup_s = 0;
    p.rules.accuracy_duration_s = 0.05;
    p.groups = {{{&scene, &entry_, {{"substeps", substeps}}, "default"}}};
    return p;
  }
  /// What going on is refused with, by a look before anything is written and by the run itself.
  std::string refusal(const CellPlan& p) const {
    std::string looked = "no error";
    try {
      require_same_cells(options_.out, p, true);
    } catch (const Error& e) {
      EXPECT_EQ(e.code(), ExitCode::BadInput);
      looked = e.what();
    }
    try {
      run_cells(p, options_);
      EXPECT_EQ(looked, "no error") << "the run did not refuse";
    } catch (const Error& e) {
      EXPECT_EQ(looked, e.what());
    }
    return looked;
  }

  RunOptions options_;
  SolverEntry entry_ = [] {
    SolverEntry e = find_solver("ballistic");
    const auto make = e.make;
    e.make = [make](const nlohmann::json&, const DeviceOptions& d) { return make(nlohmann::json::object(), d); };
    return e;
  }();
  const Scene scene_ = load_scene("paper/gravity", {"cloth.grid=[4,4]"}),
              edited_ = load_scene("paper/gravity", {"cloth.grid=[4,5]"});
};

TEST_F(Resume, TheSameIsGoneOnWith) {
  run_cells(plan(scene_), options_);
  EXPECT_EQ(refusal(plan(scene_)), "no error");
}

TEST_F(Resume, AnotherSceneOfTheSameNameIsRefused) {
  const fs::path file = run_cells(plan(scene_), options_).files.at(0);
  const std::string text = refusal(plan(edited_));
  EXPECT_NE(text.find(file.string()), std::string::npos) << text;
  EXPECT_NE(text.find(scene_.sha256.substr(0, 12)), std::string::npos) << text;
  EXPECT_NE(text.find(edited_.sha256.substr(0, 12)), std::string::npos) << text;
  EXPECT_NE(text.find("--out"), std::string::npos) << text;
}

TEST_F(Resume, ACellThatWasOnlyBegunIsLookedAtToo) {
  const Cell cell(plan(scene_).groups[0][0], {}, "test");
  const CellWriter begun(options_.out, cell.header());
  const PlannedCell same{cell_name(cell.header()), scene_.sha256, {{"substeps", 4}}, &entry_.info};
  PlannedCell other = same;
  other.scenario_sha256 = edited_.sha256;
  require_same_cells(options_.out, {same}, false);
  EXPECT_THROW(require_same_cells(options_.out, {other}, false), Error);
  EXPECT_THROW(require_same_cells(options_.out, {other}, true), Error);
}

TEST_F(Resume, OtherSettingsAreRefusedAndDefaultsAreFilledIn) {
  run_cells(plan(scene_), options_);
  EXPECT_NE(refusal(plan(scene_, 5)).find("\"substeps\":5"), std::string::npos);
  const std::string name = scene_.name + "__ballistic__default";
  require_same_cell(options_.out, {name, scene_.sha256, nlohmann::json::object(), &entry_.info});
  require_same_cell(options_.out, {name, scene_.sha256, nlohmann::json::object(), nullptr});
  EXPECT_THROW(require_same_cell(options_.out, {name, scene_.sha256, {{"substeps", 5}}, nullptr}), Error);
}

/// What an earlier version stored has the knobs of `tuning` beside the other settings.
TEST_F(Resume, BothPlacesOfAKnobAreTheSameSettings) {
  entry_.info.tuning = {{"lanes", "0", "of a test"}};
  const auto with = [&](const nlohmann::json& settings) {
    CellPlan p = plan(scene_);
    p.groups[0][0].settings = settings;
    return p;
  };
  const CellPlan once = with({{"substeps", 4}, {"lanes", 2}}),
                 now = with({{"substeps", 4}, {"tuning", {{"lanes", 2}}}}),
                 other = with({{"substeps", 4}, {"tuning", {{"lanes", 1}}}});
  const Cell cell(once.groups[0][0], {}, "test");
  CellWriter(options_.out, cell.header());
  EXPECT_THROW(require_same_cells(options_.out, other, true), Error);
  EXPECT_EQ(refusal(now), "no error") << "begun by the earlier version, finished by this";
  EXPECT_EQ(refusal(once), "no error") << "of a finished cell";
}

TEST_F(Resume, AnotherVersionOfTheSolverIsRefused) {
  run_cells(plan(scene_), options_);
  entry_.info.version += "-next";
  EXPECT_NE(refusal(plan(scene_)).find("-next"), std::string::npos);
}

TEST_F(Resume, WithoutItWhatIsFinishedIsRefused) {
  run_cells(plan(scene_), options_);
  EXPECT_THROW(require_same_cells(options_.out, plan(scene_), false), Error);
}

}  // namespace
}  // namespace clothbench

// V14 and V15: friction of `xpbd` by the closed forms. Bounds are what is reached on a software device, not what is
// hoped for.
#include <gtest/gtest.h>

#include <cmath>
#include <cstdlib>
#include <nlohmann/json.hpp>

#include "clothbench/error.hpp"
#include "metrics/truth_errors.hpp"
#include "runner/threshold.hpp"
#include "scenario/load.hpp"

namespace clothbench {
namespace {

class Friction : public ::testing::Test {
 protected:
  void SetUp() override {
    for (const SolverEntry& e : solvers())
      if (e.info.name == "xpbd") entry_ = &e;
    if (entry_ == nullptr) GTEST_SKIP() << "xpbd is not in this build";
    settings_ = complete_settings(entry_->info, nlohmann::json::object());
    try {
      entry_->make(settings_, {})->device();
    } catch (const Error& e) {
      const char* allowed = std::getenv("CLOTHBENCH_ALLOW_NO_DEVICE");
      if (e.code() == ExitCode::NoDevice && allowed != nullptr && std::string(allowed) == "1") GTEST_SKIP() << e.what();
      FAIL() << e.what();
    }
  }

  /// Error of the reference case's quantity in the last frame.
  double end_error(const std::string& name) {
    const Scene s = load_scene("validation/" + name);
    const auto solver = entry_->make(settings_, {});
    solver->load(s);
    const double dt = s.time.dt();
    for (int f = 0; f < s.time.frames(); ++f)
      EXPECT_EQ(solver->step({f, (f + 1) * dt, dt, s.motion_after(f)}), StepStatus::Ok);
    ClothState state;
    solver->read_state(state);
    const TruthErrors e = TruthJudge(s).judge(s.time.frames(), state);
    std::printf("%s: quantity %.6g, error %.3g\n", name.c_str(), e.quantity, e.quantity_error);
    return e.quantity_error;
  }

  const SolverEntry* entry_ = nullptr;
  nlohmann::json settings_;
};

TEST_F(Friction, StickSlipStop) {
  EXPECT_LE(end_error("incline-stick"), 1e-4) << "creep over L in 2 s";
  EXPECT_LE(end_error("incline-slip"), 0.02);
  EXPECT_LE(end_error("incline-stop"), 0.02) << "stopping distance";
  settings_["substeps"] = 64;
  EXPECT_LE(end_error("incline-stick"), 1e-4);
  settings_["substeps"] = 256;
  EXPECT_LE(end_error("incline-stick"), 1e-3)
      << "what a substep falls, 3e-8 m, is less than the rounding of a position";
  EXPECT_LE(end_error("incline-slip"), 0.02);
}

TEST_F(Friction, CriticalAngleWithinATenthOfADegree) {
  const FoundThreshold t = find_threshold(load_scene("validation/incline-stick"), *entry_, settings_, {});
  std::printf("critical angle off by %.4f degree after %d runs\n", t.error, t.runs);
  EXPECT_FALSE(t.holds_at_least || t.slips_at_most);
  EXPECT_LE(std::abs(t.error), 0.1);
}

TEST_F(Friction, CapstanHoldsWithinThreePerCent) {
  const Scene s = load_scene("validation/capstan-hold");
  const FoundThreshold standard = find_threshold(s, *entry_, settings_, {});
  std::printf("capstan, default: overhang off by %.4f after %d runs\n", standard.error, standard.runs);
  EXPECT_FALSE(standard.holds_at_least || standard.slips_at_most);
  EXPECT_LE(std::abs(standard.error), 0.03);
  settings_["substeps"] = 64;
  const FoundThreshold rows = find_threshold(s, *entry_, settings_, {});
  std::printf("capstan, 64 substeps: overhang off by %.4f after %d runs\n", rows.error, rows.runs);
  EXPECT_LE(std::abs(rows.error), 0.03);
}

/// The error falls with the substeps, of which a finer strip has more at default.
TEST_F(Friction, CapstanSlidesWithinFivePerCent) { EXPECT_LE(end_error("capstan-slip"), 0.05); }

TEST(Threshold, IsOnlyOfScenesThatHaveOne) {
  const SolverEntry& ballistic = find_solver("ballistic");
  EXPECT_THROW(find_threshold(load_scene("validation/incline-stop"), ballistic, nlohmann::json::object(), {}), Error);
  // Falls through everything, at any friction, and so is never held.
  const FoundThreshold t =
      find_threshold(load_scene("validation/incline-stick"), ballistic, nlohmann::json::object(), {});
  EXPECT_TRUE(t.slips_at_most);
}

}  // namespace
}  // namespace clothbench

// V14 and V15: friction of `xpbd` against closed forms. The bounds are errors that it reaches on a software device.
#include <gtest/gtest.h>

#include <cmath>
#include <cstdlib>
#include <nlohmann/json.hpp>
#include <numbers>

#include "metrics/truth_errors.hpp"
#include "scenario/load.hpp"
#include "sheets.hpp"
#include "solvers.hpp"

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
      if (may_lack_device(e)) GTEST_SKIP() << e.what();
      FAIL() << e.what();
    }
  }

  /// Error of the reference case's quantity in the last frame.
  double end_error(const std::string& name) { return end_errors(name).quantity_error; }

  TruthErrors end_errors(const std::string& name, const std::vector<std::string>& overrides = {}) {
    const Scene s = load_scene("validation/" + name, overrides);
    const auto solver = entry_->make(settings_, {});
    solver->load(s);
    const TruthErrors e = TruthJudge(s).judge(s.time.frames(), after(*solver, s, s.time.frames()));
    std::printf("%s: quantity %.6g, error %.3g\n", name.c_str(), e.quantity, e.quantity_error);
    return e;
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
      << "the fall in one substep, 3e-8 m, is less than the rounding of a position";
  EXPECT_LE(end_error("incline-slip"), 0.02);
}

TEST_F(Friction, CriticalAngleWithinATenthOfADegree) {
  const auto quantity = [&](double degrees) {
    const double friction = std::tan(degrees * std::numbers::pi / 180);
    return end_errors("incline-stick", {"colliders.0.friction=" + std::to_string(friction)}).quantity;
  };
  EXPECT_LE(std::abs(quantity(16.1)), 0.1 * quantity(15.9)) << "the slope of 16 degrees";
  EXPECT_GE(quantity(15.9), 0.01) << "m in 2 s";
}

/// The error decreases with more substeps; by default, a finer strip uses more substeps.
TEST_F(Friction, CapstanSlidesWithinFivePerCent) { EXPECT_LE(end_error("capstan-slip"), 0.05); }

}  // namespace
}  // namespace clothbench

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "metrics/metric.hpp"
#include "scenario/load.hpp"

namespace clothbench {
namespace {

constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();

class Metrics : public ::testing::Test {
 protected:
  Metrics() : scene_(load_scene("paper/gravity", {"cloth.grid=[9,5]", "cloth.size_m=[2,0.5]", "material.damping_per_s=0"})) {
    state_.position = initial_positions(scene_);
    state_.velocity.assign(state_.position.size(), 0);
  }
  MetricContext context() const { return {scene_, find_solver("ballistic"), settings_}; }

  Scene scene_;
  nlohmann::json settings_ = nlohmann::json::object();
  ClothState state_;
};

TEST_F(Metrics, AScaledSheetHasExactlyThatStretch) {
  for (double factor : {0.9, 1.0, 1.01, 2.0}) {
    ClothState s = state_;
    for (double& x : s.position) x *= factor;
    for (const auto metric : {stretch_max, stretch_mean})
      EXPECT_NEAR(metric(context(), 1, s), factor - 1, 1e-14);
    EXPECT_NEAR(stretch_rms(context(), 1, s), std::abs(factor - 1), 1e-14);
  }
}

TEST_F(Metrics, OneLongEdgeIsTheMaximum) {
  ClothState s = state_;
  s.position[0] -= 0.25;  // the first vertex, one cell outwards along u: its edge along v is slanted most, 0.25 by 0.125
  EXPECT_NEAR(stretch_max(context(), 1, s), std::sqrt(5.0) - 1, 1e-14);
}

TEST_F(Metrics, FreeFallErrorIsZeroOnTheClosedFormAndScaledByHalfGTSquared) {
  const int frame = 36;
  const double t = frame * scene_.time.dt(), fall = context().entry.free_fall_m(scene_, settings_, frame);
  ClothState s = state_;
  for (std::size_t k = 1; k < s.position.size(); k += 3) s.position[k] += fall;
  EXPECT_LE(free_fall_error_max(context(), frame, s), 1e-15);
  s.position[3] += 0.5 * 9.81 * t * t;
  EXPECT_NEAR(free_fall_error_max(context(), frame, s), 1, 1e-14);
  EXPECT_NEAR(free_fall_error_rms(context(), frame, s), 1 / std::sqrt(45.0), 1e-14);
  EXPECT_TRUE(std::isnan(free_fall_error_max(context(), 0, s))) << "at T = 0 there is nothing to divide by";
}

TEST_F(Metrics, MomentumOfAFallingSheetIsGravitys) {
  ClothState s = state_;
  const int frame = 20;
  for (std::size_t k = 1; k < s.velocity.size(); k += 3) s.velocity[k] = -9.81 * frame * scene_.time.dt();
  EXPECT_LE(momentum_error(context(), frame, s), 1e-14);
  for (std::size_t k = 0; k < s.velocity.size(); k += 3) s.velocity[k] = std::sqrt(9.81 * 2);
  EXPECT_NEAR(momentum_error(context(), frame, s), 1, 1e-13);
}

TEST_F(Metrics, NaNAnywhereMakesEveryMetricNaN) {
  for (std::size_t at : {std::size_t{0}, state_.position.size() / 2, state_.position.size() - 1}) {
    ClothState s = state_;
    s.position[at] = kNaN;
    s.velocity[at] = kNaN;
    for (const Metric& m : metrics()) {
      if (!m.applies(scene_)) continue;
      EXPECT_TRUE(std::isnan(m.value(context(), 36, s))) << m.name << " hides a NaN at " << at;
    }
  }
}

TEST_F(Metrics, ASceneOnlyGetsWhatAppliesToIt) {
  const auto applies = [](const Scene& s, const std::string& name) {
    for (const Metric& m : metrics())
      if (m.name == name) return m.applies(s);
    ADD_FAILURE() << "no metric " << name;
    return false;
  };
  EXPECT_TRUE(applies(scene_, "free_fall_error"));
  const Scene pinned = load_scene("paper/gravity", {"pins=[{\"edge\":\"v0\"}]"});
  EXPECT_FALSE(applies(pinned, "free_fall_error")) << "a pinned cloth does not fall freely";
  EXPECT_FALSE(applies(pinned, "momentum_error"));
  EXPECT_TRUE(applies(pinned, "stretch_max"));
}

}  // namespace
}  // namespace clothbench

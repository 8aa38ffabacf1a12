#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <set>

#include "metrics/registry.hpp"
#include "scenario/load.hpp"

namespace clothbench {
namespace {

constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();

class Metrics : public ::testing::Test {
 protected:
  Metrics()
      : scene_(load_scene("paper/gravity", {"cloth.grid=[9,5]", "cloth.size_m=[2,0.5]", "material.damping_per_s=0"})) {
    state_.position = initial_positions(scene_);
    state_.velocity.assign(state_.position.size(), 0);
  }
  MetricContext context() const { return {scene_, find_solver("ballistic"), settings_}; }
  static const Metric& metric(const std::string& name) {
    for (const Metric& m : metrics())
      if (m.name == name) return m;
    throw std::runtime_error("no metric " + name);
  }
  double value(const std::string& name, int frame, const ClothState& state) const {
    const MetricContext c = context();
    return metric(name).value({c, frame, state});
  }

  Scene scene_;
  nlohmann::json settings_ = nlohmann::json::object();
  ClothState state_;
};

TEST_F(Metrics, AScaledSheetHasExactlyThatStretch) {
  for (double factor : {0.9, 1.0, 1.01, 2.0}) {
    ClothState s = state_;
    for (double& x : s.position) x *= factor;
    EXPECT_NEAR(value("stretch_max", 1, s), factor - 1, 1e-14);
    EXPECT_NEAR(value("stretch_mean_positive", 1, s), std::max(factor - 1, 0.0), 1e-14);
  }
}

TEST_F(Metrics, FreeFallErrorIsZeroOnTheClosedFormAndScaledByHalfGTSquared) {
  const int frame = 36;
  const double t = frame * scene_.time.dt(), fall = context().entry.free_fall_m(scene_, settings_, frame);
  ClothState s = state_;
  for (std::size_t k = 1; k < s.position.size(); k += 3) s.position[k] += fall;
  EXPECT_LE(value("free_fall_error", frame, s), 1e-15);
  s.position[3] += 0.5 * 9.81 * t * t;
  EXPECT_NEAR(value("free_fall_error", frame, s), 1, 1e-14);
  EXPECT_TRUE(std::isnan(value("free_fall_error", 0, s))) << "at T = 0 there is nothing to divide by";
}

TEST_F(Metrics, FreeFallGoesWhereGravityAndTheInitialVelocitySendIt) {
  const char* damping = "material.damping_per_s=2";
  for (const char* gravity : {"gravity_m_per_s2=[9.81,0,0]", "gravity_m_per_s2=[1,-2,3]"})
    for (const SolverEntry& entry : solvers()) {
      const Scene scene = load_scene("paper/gravity",
                                     {"cloth.grid=[3,3]", gravity, damping, "cloth.initial_velocity_m_per_s=[0,1,-4]"});
      const nlohmann::json settings = complete_settings(entry.info, nlohmann::json::object());
      const MetricContext c{scene, entry, settings};
      const int frame = 36;
      const double t = frame * scene.time.dt(), keep = std::exp(-2 * t);
      // x(t) of dv/dt = g - c v. A solver that ignores damping must match the fall without damping.
      const bool damps = !entry.info.ignores.has(Feature::Damping);
      ClothState s;
      s.position = initial_positions(scene);
      s.velocity.assign(s.position.size(), 0);
      for (std::size_t k = 0; k < s.position.size(); ++k) {
        const double g = scene.gravity_m_per_s2[k % 3], v = scene.cloth.initial_velocity_m_per_s[k % 3];
        s.position[k] += damps ? g / 2 * t + (v - g / 2) * (1 - keep) / 2 : v * t + g * t * t / 2;
      }
      const double error = metric("free_fall_error").value({c, frame, s});
      EXPECT_LE(error, 0.1) << entry.info.name << ": the integrator's own error is of first order in the step";
      EXPECT_GT(error, 0);
    }
}

TEST_F(Metrics, NaNAnywhereMakesEveryMetricNaN) {
  for (std::size_t at : {std::size_t{0}, state_.position.size() / 2, state_.position.size() - 1}) {
    ClothState s = state_;
    s.position[at] = kNaN;
    s.velocity[at] = kNaN;
    for (const Metric& m : metrics()) {
      if (!m.applies(scene_)) continue;
      const MetricContext c = context();
      EXPECT_TRUE(std::isnan(m.value({c, 36, s}))) << m.name << " hides a NaN at " << at;
    }
  }
}

TEST_F(Metrics, ASceneOnlyGetsWhatAppliesToIt) {
  const auto applies = [](const Scene& s, const std::string& name) { return metric(name).applies(s); };
  EXPECT_TRUE(applies(scene_, "free_fall_error"));
  const Scene pinned = load_scene("paper/gravity", {"pins=[{\"edge\":\"v0\"}]"});
  EXPECT_FALSE(applies(pinned, "free_fall_error")) << "a pinned cloth does not fall freely";
  EXPECT_TRUE(applies(pinned, "stretch_max"));
  for (const char* contact : {"contact_length_m", "depth_m"}) EXPECT_FALSE(applies(scene_, contact)) << contact;
  const Scene sheet = load_scene("contact/open-sheet"), ball = load_scene("contact/sphere");
  EXPECT_TRUE(applies(sheet, "contact_length_m"));
  EXPECT_FALSE(applies(sheet, "depth_m")) << "an open sheet has no inside";
  EXPECT_TRUE(applies(ball, "depth_m"));
}

TEST(Registry, EveryEntryIsWhole) {
  std::set<std::string> series, names;
  std::set<int> columns;
  for (const Metric& m : metrics()) {
    EXPECT_TRUE(series.insert(m.name).second) << m.name << " stands twice";
    EXPECT_FALSE(m.units.empty() || m.long_name.empty() || std::string(m.needs.words).empty()) << m.name;
    EXPECT_TRUE(m.series_column == 0 || columns.insert(m.series_column).second) << m.name << ": its column is taken";
  }
  for (const Scalar& s : scalars()) {
    EXPECT_TRUE(names.insert(s.name).second) << s.name << " stands twice";
    EXPECT_EQ(find_scalar(s.name), &s) << s.name;
    EXPECT_FALSE(s.units.empty() || s.doc.empty()) << s.name;
    EXPECT_TRUE(s.expect == Expect::No || s.present == nullptr) << s.name << ": a bound needs a value";
    for (const std::string& of : s.from.series) EXPECT_TRUE(series.contains(of)) << s.name << " is of " << of;
  }
}

TEST(Registry, ASeriesThatARunLacksHasNoScalars) {
  const Scene scene = load_scene("paper/gravity");
  const AccuracyPass nothing;
  for (const auto& [name, value] : scalars_of({scene, nothing})) EXPECT_TRUE(std::isnan(value)) << name;
}

}  // namespace
}  // namespace clothbench

// Each outcome class on frames that just trigger it, and on frames that just do not.
#include "metrics/stability/judge.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "metrics/registry.hpp"
#include "scenario/load.hpp"

namespace clothbench {
namespace {

using nlohmann::json;

constexpr unsigned F(int k) { return 1u << k; }

class Judge : public ::testing::Test {
 protected:
  Judge() { load(); }
  /// A hanging sheet of 9 x 9 cells of 0.125 m, all classes evaluated, 60 frames.
  void load(const std::vector<std::string>& set = {}) {
    std::vector<std::string> all = {R"(stability={"case": "S01", "judged": ["F0", "F1", "F2"], "settle_s": 0.5})"};
    all.insert(all.end(), set.begin(), set.end());
    scene_ = scene_from_json(
        json::parse(R"({"name": "judged", "why": "frames made by hand", "cloth": {"grid": [9, 9], "size_m": [1, 1],
      "areal_density_kg_per_m2": 0.2, "sides": "single", "pose": {"axis_u": [1, 0, 0], "axis_v": [0, -1, 0]}},
      "material": {"membrane_stiffness_N_per_m": "inextensible"}, "pins": [{"edge": "v0"}], "time": {"frame_rate_hz": 60, "duration_s": 1}})"),
        "test", all);
    judge_ = std::make_unique<StabilityJudge>(scene_);
    rest_.position = initial_positions(scene_);
    rest_.velocity.assign(rest_.position.size(), 0);
    next_ = 0;
  }
  StabilityFrame add(const ClothState& s) { return judge_->judge(next_++, s, {}); }
  ClothState stretched(double factor) const {
    ClothState s = rest_;
    for (std::size_t v = 0; v < s.position.size() / 3; ++v)
      s.position[3 * v + 1] = 0.5 + factor * (rest_.position[3 * v + 1] - 0.5);
    return s;
  }

  Scene scene_;
  std::unique_ptr<StabilityJudge> judge_;
  ClothState rest_;
  int next_ = 0;
};

TEST_F(Judge, RestIsStable) {
  for (int f = 0; f <= scene_.time.frames(); ++f) EXPECT_EQ(add(rest_).classes, 0u) << f;
}

TEST_F(Judge, F0NotFinite) {
  for (double bad : {std::nan(""), std::numeric_limits<double>::infinity()})
    for (const bool velocity : {false, true}) {
      load();
      ClothState s = rest_;
      (velocity ? s.velocity : s.position)[7] = bad;
      const StabilityFrame f = add(s);
      EXPECT_EQ(f.classes, F(0));
      EXPECT_TRUE(std::isnan(f.speed));
    }
}

TEST_F(Judge, F0Unbounded) {
  // Free fall by twice the diagonal gives 7.45 m/s; the limit is ten times that.
  const double most = 10 * std::sqrt(2 * 9.81 * 2 * std::sqrt(2.0));
  ClothState s = rest_;
  s.velocity[40] = 0.99 * most;
  EXPECT_EQ(add(s).classes & F(0), 0u);
  s.velocity[40] = 1.01 * most;
  EXPECT_EQ(add(s).classes & F(0), F(0));
}

TEST_F(Judge, F1EnergyGain) {
  ClothState s = rest_;
  const double M = 0.2, gL = 9.81;
  add(s);
  // Equal velocities: M v^2 / 2 = gain M g L; the pinned vertices count only in the sum.
  for (const double gain : {0.099, 0.101}) {
    for (std::size_t k = 0; k < s.velocity.size(); k += 3) s.velocity[k] = std::sqrt(2 * gain * gL);
    const StabilityFrame f = add(s);
    EXPECT_NEAR(f.energy_gain, gain, 1e-9 * M);
    EXPECT_EQ((f.classes & F(1)) != 0, gain > 0.1);
  }
}

TEST_F(Judge, F1FallingIsNoGain) {
  ClothState s = rest_;
  add(s);
  for (std::size_t k = 1; k < s.position.size(); k += 3) {
    s.position[k] -= 1;
    s.velocity[k] = -std::sqrt(2 * 9.81);
  }
  EXPECT_NEAR(add(s).energy_gain, 0, 1e-12);
}

TEST_F(Judge, F2OneEdgeFourFramesInARow) {
  ClothState s = rest_;
  s.position[3 * 80 + 1] -= 0.125 * 0.2;  // the last vertex: one edge in 144, below the 99th percentile
  for (int f = 0; f < 3; ++f) EXPECT_EQ(add(s).classes & F(2), 0u) << f;
  EXPECT_EQ(add(s).classes & F(2), F(2));
  EXPECT_EQ(add(rest_).classes & F(2), 0u);
  for (int f = 0; f < 3; ++f) EXPECT_EQ(add(s).classes & F(2), 0u) << "counts anew";
}

TEST_F(Judge, F2ManyEdgesAtOnce) {
  EXPECT_EQ(add(stretched(1.049)).classes & F(2), 0u);
  EXPECT_EQ(add(stretched(1.051)).classes & F(2), F(2));
}

TEST_F(Judge, F2Torn) {
  ClothState s = rest_;
  s.position[3 * 80 + 1] -= 0.125 * 1.01;
  EXPECT_EQ(add(s).classes & F(2), F(2));
}

TEST_F(Judge, F2AllowsWhatTheLoadsDo) {
  load({"material.membrane_stiffness_N_per_m=10"});
  // M g / (Y w) = 0.196; a sudden load doubles it.
  EXPECT_EQ(add(stretched(1.39)).classes & F(2), 0u);
}

TEST_F(Judge, WaitsForTheClothToRelax) {
  load({R"(stability={"case": "S15", "judged": ["F0", "F1", "F2"], "from": "relaxed", "relax_s": 0.2})",
        R"(cloth.start={"shape": "sphere", "radius_m": 3})"});
  const ClothState ball = rest_;
  for (int j = 0; j < 9; ++j)
    for (int i = 0; i < 9; ++i) {
      const Vec3 x = scene_.rest_position(i, j);
      for (std::size_t k = 0; k < 3; ++k) rest_.position[3 * static_cast<std::size_t>(9 * j + i) + k] = x[k];
    }
  for (int f = 0; f <= 12; ++f) EXPECT_EQ(add(ball).classes, 0u) << f;
  EXPECT_EQ(add(ball).classes, F(2)) << "not relaxed in time";
  EXPECT_EQ(add(rest_).classes, 0u);
  EXPECT_EQ(add(stretched(1.1)).classes & F(2), F(2)) << "judged from now on";
}

TEST_F(Judge, AJumpStartsTheWaitAnew) {
  load({R"(stability={"case": "S08", "judged": ["F0", "F1", "F2"], "from": "relaxed"})", "pins=[]",
        R"(grips=[{"edge": "v0", "velocity_m_per_s": [0, 0, 0], "jumps": [{"time_s": 0.1, "by_m": [0.5, 0, 0]}]}])"});
  while (next_ < 7) add(rest_);
  ClothState fast = stretched(1.5);
  fast.velocity[100] = 9 * 0.5 * 60;  // under 10 times the jump's speed
  EXPECT_EQ(add(fast).classes, 0u);
  fast.velocity[100] = 11 * 0.5 * 60;
  EXPECT_EQ(add(fast).classes, F(0));
  EXPECT_EQ(add(rest_).classes, 0u);
}

TEST_F(Judge, OnlyWhatTheSceneJudgesCounts) {
  load({R"(stability={"case": "S10", "judged": ["F0"]})"});
  ClothState s = stretched(3);
  EXPECT_EQ(add(s).classes, 0u);
  s.velocity[10] = 1e6;
  EXPECT_EQ(add(s).classes, F(0));
  s.velocity[10] = std::nan("");
  EXPECT_EQ(add(s).classes, F(0));
}

AccuracyPass pass_of(const std::vector<unsigned>& classes) {
  AccuracyPass pass;
  MetricSeries m{"stability_classes", "1", "", {}};
  for (std::size_t f = 0; f < classes.size(); ++f) {
    pass.time_s.push_back(static_cast<double>(f));
    m.values.push_back(classes[f]);
  }
  pass.metrics = {m};
  return pass;
}

TEST(Verdict, WorstGradeFirstFrame) {
  using Grade = StabilityVerdict::Grade;
  EXPECT_EQ(stability_verdict(pass_of({0, 0})).grade, Grade::Stable);
  const StabilityVerdict degraded = stability_verdict(pass_of({0, F(2), 0}));
  EXPECT_EQ(degraded.grade, Grade::Degraded);
  EXPECT_EQ(degraded.klass, "F2");
  EXPECT_EQ(degraded.frame, 1);
  const StabilityVerdict failed = stability_verdict(pass_of({0, F(2), F(1) | F(2), F(0)}));
  EXPECT_EQ(failed.grade, Grade::Failed);
  EXPECT_EQ(failed.klass, "F1");
  EXPECT_EQ(failed.frame, 2);
}

TEST(Verdict, F3ComesFromTheRunner) {
  Scene judged;
  judged.stability.name = "S01";
  Outcome lost;
  lost.status = "device_lost";
  lost.klass = "F3";
  lost.failed_frame = 5;
  const auto s = scalars_of({judged, pass_of({0, F(2)}), lost});
  EXPECT_EQ(s.at("stability_grade"), 2);
  Outcome absent;
  absent.status = "unsupported";
  EXPECT_TRUE(std::isnan(scalars_of({judged, AccuracyPass(), absent}).at("stability_grade")));
  EXPECT_TRUE(scalars_of({Scene(), AccuracyPass(), {}}, "stability_").empty());
}

}  // namespace
}  // namespace clothbench

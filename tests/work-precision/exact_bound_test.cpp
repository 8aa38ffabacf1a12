// What a scene with an exact solution expects by itself: the solution passes, one that is off on either side fails.
#include "metrics/exact_bound.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "base/json_text.hpp"
#include "metrics/metric_pass.hpp"
#include "metrics/registry.hpp"
#include "runner/expect.hpp"
#include "scenario/load.hpp"
#include "truth/draw.hpp"
#include "truth/tolerance.hpp"

namespace clothbench {
namespace {

using Motion = std::function<std::vector<double>(int frame)>;

/// The verdict on a run with these positions.
std::string verdict(const Scene& s, const Motion& motion) {
  const nlohmann::json settings = nlohmann::json::object();
  const MetricContext context{s, find_solver("ballistic"), settings};
  MetricPass metrics(context);
  AccuracyPass pass;
  for (int f = 0; f <= s.time.frames(); ++f) {
    ClothState state{motion(f), {}};
    state.velocity.assign(state.position.size(), 0);
    metrics.add(state);
    pass.time_s.push_back(s.time.at(f));
  }
  pass.metrics = metrics.take();
  auto summary = scalars_of({s, pass}, "truth_");
  if (!s.stability.name.empty()) summary["stability_grade"] = 0;  // another expectation, of frames with velocities
  return judge(s, {}, pass, summary).text;
}

/// The exact solution in every frame; a shape at rest is there from the start.
std::vector<std::vector<double>> exact_frames(const Scene& s, const truth::ReferenceCase& known) {
  std::vector<std::vector<double>> out;
  for (int f = 0; f <= s.time.frames(); ++f) out.push_back(truth::vertex_positions(s.cloth, known, f));
  return out;
}

/// Start + k (exact - start).
Motion scaled(const Scene& s, const std::vector<std::vector<double>>& exact, double k) {
  return [&exact, k, start = initial_positions(s)](int frame) {
    std::vector<double> out = exact[static_cast<std::size_t>(frame)];
    for (std::size_t i = 0; i < out.size(); ++i) out[i] = start[i] + k * (out[i] - start[i]);
    return out;
  };
}

/// The start, farther along axis_u by a share of the longer side.
Motion crept(const Scene& s, double share) {
  std::vector<double> out = initial_positions(s);
  const double by_m = share * std::max(s.cloth.width_m, s.cloth.height_m);
  for (std::size_t i = 0; i < out.size(); ++i) out[i] += by_m * s.cloth.axis_u[i % 3];
  return [out](int) { return out; };
}

void expect_two_sided(const Scene& s) {
  const auto known = *truth::reference_case_of(s);
  const truth::Tolerance& tolerance = truth::tolerance_of(known.name);
  const auto exact = exact_frames(s, known);
  const auto fails = [&](const Motion& motion) { return verdict(s, motion).starts_with("fail: truth_"); };
  EXPECT_EQ(verdict(s, scaled(s, exact, 1)), "pass");
  const std::vector<double> start = initial_positions(s);
  double moved_m = 0;
  for (std::size_t i = 0; i < start.size(); ++i) moved_m = std::max(moved_m, std::abs(exact.back()[i] - start[i]));
  if (moved_m > 1e-12) {
    for (const double sign : {-1.0, 1.0}) {
      EXPECT_TRUE(fails(scaled(s, exact, 1 + sign * 3 * tolerance.of_motion))) << sign;
      EXPECT_EQ(verdict(s, scaled(s, exact, 1 + sign * 0.5 * tolerance.of_motion)), "pass") << sign;
    }
    EXPECT_TRUE(fails(scaled(s, exact, 0))) << "frozen";
  } else {
    ASSERT_GT(tolerance.at_rest, 0);
    for (const double sign : {-1.0, 1.0}) {
      EXPECT_TRUE(fails(crept(s, sign * 3 * tolerance.at_rest))) << sign;
      EXPECT_EQ(verdict(s, crept(s, sign * 0.5 * tolerance.at_rest)), "pass") << sign;
    }
  }
  EXPECT_TRUE(fails([&](int frame) {
    std::vector<double> x = exact[static_cast<std::size_t>(frame)];
    if (frame == s.time.frames()) x[1] = NAN;
    return x;
  }));
}

class ExactBound : public ::testing::TestWithParam<std::string> {};

std::vector<std::string> scenes_with_a_solution() {
  std::vector<std::string> out;
  for (const std::string& name : scene_names({"validation", "stability"}))
    if (!load_scene(name).reference_case.empty()) out.push_back(name);
  return out;
}

INSTANTIATE_TEST_SUITE_P(Every, ExactBound, ::testing::ValuesIn(scenes_with_a_solution()), [](const auto& i) {
  std::string name = i.param;
  for (char& c : name)
    if (std::isalnum(static_cast<unsigned char>(c)) == 0) c = '_';
  return name;
});

TEST_P(ExactBound, TheSolutionPassesAndWhatIsOffOnEitherSideFails) { expect_two_sided(load_scene(GetParam())); }

TEST_P(ExactBound, HoldsForDrawnParameters) {
  const Scene s = load_scene(GetParam());
  if (!GetParam().starts_with("validation/")) GTEST_SKIP() << "its kind is drawn from the scene in validation/";
  const bool integrated = s.reference_case.find("sheet") != std::string::npos;
  for (const std::uint64_t seed : {1, 2, 3, 4, 5}) {
    SCOPED_TRACE(seed);
    expect_two_sided(truth::draw(s, seed).scene);
    if (integrated) break;  // it takes longer
  }
}

TEST(Tolerances, EveryReferenceCaseHasOneAndItsReason) {
  const nlohmann::json schema = nlohmann::json::parse(read_text(scenario_root() / "schema/scene.schema.json"));
  const nlohmann::json names = schema.at("properties").at("truth").at("properties").at("case").at("enum");
  EXPECT_EQ(names.size(), truth::tolerances().size());
  for (const auto& name : names) {
    const truth::Tolerance& t = truth::tolerance_of(name.get<std::string>());
    EXPECT_TRUE(t.of_motion > 0 && t.of_motion <= 0.03) << name;
    EXPECT_TRUE(t.at_rest >= 0 && t.at_rest <= 0.005) << name;
    EXPECT_FALSE(t.why.empty());
  }
}

/// A scene with an exact solution needs no `expect`; the bound is that of the parameters in use.
TEST(ExactBound, FollowsOverridesAndNeedsNoFile) {
  const Scene moon = load_scene("validation/incline-slip", {"gravity_m_per_s2=[0,-1.6,0]"});
  EXPECT_TRUE(moon.expect.empty());
  const auto exact = exact_frames(moon, *truth::reference_case_of(moon));
  EXPECT_EQ(verdict(moon, scaled(moon, exact, 1)), "pass");
  EXPECT_TRUE(verdict(moon, scaled(moon, exact, 9.81 / 1.6)).starts_with("fail: truth_"));
  Outcome broken;
  broken.status = "diverged";
  EXPECT_TRUE(judge(moon, broken, {}, {}).text.starts_with("fail: outcome diverged, expected ok"));
}

/// Positions that are right but were rounded to float32, ten metres from the origin, still pass.
TEST(ExactBound, AllowsTheRoundingOfFloat32) {
  const Scene s = load_scene("validation/heavy-strip",
                             {"material.membrane_stiffness_N_per_m=1e6", "cloth.pose.center_m=[10,9.5,10]"});
  const auto exact = exact_frames(s, *truth::reference_case_of(s));
  const auto rounded = [&](int frame) {
    std::vector<double> x = exact[static_cast<std::size_t>(frame)];
    for (double& v : x) v = static_cast<float>(v);
    return x;
  };
  EXPECT_EQ(verdict(s, rounded), "pass");
  EXPECT_TRUE(verdict(s, crept(s, 1e-5)).starts_with("fail: truth_"));
}

}  // namespace
}  // namespace clothbench

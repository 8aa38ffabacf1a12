// A scene with an exact solution has its own bounds: the solution passes, and motions that are off to either side fail.
#include <gtest/gtest.h>

#include <cmath>

#include "base/json_text.hpp"
#include "metrics/registry.hpp"
#include "metrics/truth_errors.hpp"
#include "refusal.hpp"
#include "runner/study_runner.hpp"
#include "scenario/load.hpp"
#include "scenario/study.hpp"

namespace clothbench {
namespace {

using Motion = std::function<std::vector<double>(int frame)>;

/// A scene, its exact solution in every frame, and the verdict on other motions.
class Judged {
 public:
  explicit Judged(const Scene& s) : scene(s), judge_(scene), bound_(exact_bound(judge_)) {
    for (int f = 0; f <= scene.time.frames(); ++f) {
      exact.push_back(truth::vertex_positions(scene.cloth, judge_.reference_case(), f));
      pass_.time_s.push_back(scene.time.at(f));
    }
  }

  std::string verdict(const Motion& motion) const {
    AccuracyPass pass = pass_;
    pass.metrics = {{"truth_error_e2", "1", "", {}}, {"truth_quantity_error", "1", "", {}}};
    for (int f = 0; f <= scene.time.frames(); ++f) {
      ClothState state{motion(f), {}};
      state.velocity.assign(state.position.size(), 0);
      const TruthErrors e = judge_.judge(f, state);
      pass.metrics[0].values.push_back(e.e2);
      pass.metrics[1].values.push_back(e.quantity_error);
    }
    const RunView run(scene, pass);
    std::map<std::string, double> summary = {{"truth_e2_bound", bound_.e2},
                                             {"truth_quantity_error_bound", bound_.quantity_error},
                                             {"stability_grade", 0}};  // needs velocities
    for (const char* name : kExactlyBounded) summary[name] = find_scalar(name)->from.value(run);
    return judge(scene, {}, pass, summary).text;
  }
  bool fails(const Motion& motion) const { return verdict(motion).starts_with("fail: truth_"); }

  const Scene scene;
  std::vector<std::vector<double>> exact;

 private:
  TruthJudge judge_;
  ExactBound bound_;
  AccuracyPass pass_;
};

/// Start + k (exact - start).
Motion scaled(const Judged& j, double k) {
  return [&j, k, start = initial_positions(j.scene)](int frame) {
    std::vector<double> out = j.exact[static_cast<std::size_t>(frame)];
    for (std::size_t i = 0; i < out.size(); ++i) out[i] = start[i] + k * (out[i] - start[i]);
    return out;
  };
}

/// The start, moved along axis_u by a fraction of the longer side.
Motion crept(const Scene& s, double share) {
  std::vector<double> out = initial_positions(s);
  const double by_m = share * std::max(s.cloth.width_m, s.cloth.height_m);
  for (std::size_t i = 0; i < out.size(); ++i) out[i] += by_m * s.cloth.axis_u[i % 3];
  return [out](int) { return out; };
}

/// Largest motion of a coordinate [m], and half a unit in the last place of float32 of the largest coordinate.
std::pair<double, double> moved_and_rounding_m(const Judged& j) {
  const std::vector<double> start = initial_positions(j.scene);
  double moved = 0, greatest = 0;
  for (std::size_t i = 0; i < start.size(); ++i) {
    moved = std::max(moved, std::abs(j.exact.back()[i] - start[i]));
    greatest = std::max(greatest, std::abs(start[i]));
  }
  return {moved, std::exp2(-24) * greatest};
}

void expect_two_sided(const Scene& s) {
  const Judged j(s);
  const truth::Tolerance& tolerance = truth::tolerance_of(s.reference_case);
  EXPECT_EQ(j.verdict(scaled(j, 1)), "pass");
  EXPECT_TRUE(j.fails([&](int frame) {
    std::vector<double> x = j.exact[static_cast<std::size_t>(frame)];
    if (frame == s.time.frames()) x[1] = NAN;
    return x;
  }));
  const auto [moved_m, rounding_m] = moved_and_rounding_m(j);
  const bool moves = moved_m > 1e-12;
  if (moves) {
    EXPECT_TRUE(j.fails(scaled(j, 0))) << "frozen";
  } else {
    ASSERT_GT(tolerance.at_rest, 0);
  }
  const double of = moves ? tolerance.of_motion : tolerance.at_rest;
  for (const double sign : {-1.0, 1.0}) {
    EXPECT_EQ(j.verdict(moves ? scaled(j, 1 + sign * 0.5 * of) : crept(s, sign * 0.5 * of)), "pass") << sign;
    if (moves && moved_m < 200 * rounding_m) continue;  // stiff strips far away: float32 cannot resolve some per cent
    EXPECT_TRUE(j.fails(moves ? scaled(j, 1 + sign * 3 * of) : crept(s, sign * 3 * of))) << sign;
  }
}

TEST(ExactBound, TheSolutionPassesAndWhatIsOffOnEitherSideFails) {
  for (const std::string& name : scene_names({"validation", "stability"})) {
    SCOPED_TRACE(name);
    if (const Scene s = load_scene(name); !s.reference_case.empty()) expect_two_sided(s);
  }
}

TEST(DrawnBound, TheSolutionPassesAndWhatIsOffOnEitherSideFails) {
  StudyOptions options;
  options.count = 40;
  for (const Study::Item& drawn : load_study("physics", options).scenes) {
    SCOPED_TRACE(drawn.scene.name);
    expect_two_sided(drawn.scene);
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

/// A scene with an exact solution needs no `expect`; the bound follows the actual parameters.
TEST(ExactBounds, FollowsOverridesAndNeedsNoFile) {
  const Judged moon(load_scene("validation/incline-slip", {"gravity_m_per_s2=[0,-1.6,0]"}));
  EXPECT_TRUE(moon.scene.expect.empty());
  EXPECT_EQ(moon.verdict(scaled(moon, 1)), "pass");
  EXPECT_TRUE(moon.fails(scaled(moon, 9.81 / 1.6)));
  Outcome broken;
  broken.status = "diverged";
  EXPECT_TRUE(judge(moon.scene, broken, {}, {}).text.starts_with("fail: outcome diverged, expected ok"));
}

/// The bounds are in every summary and equal those of exact_bound().
TEST(ExactBounds, IsPartOfASummary) {
  const Scene s = load_scene("validation/pendulum");
  AccuracyPass pass;
  for (int f = 0; f <= s.time.frames(); ++f) pass.time_s.push_back(s.time.at(f));
  const auto summary = scalars_of({s, pass}, "truth_");
  EXPECT_EQ(summary.at("truth_e2_bound"), exact_bound(TruthJudge(s)).e2);
  EXPECT_EQ(summary.at("truth_quantity_error_bound"), exact_bound(TruthJudge(s)).quantity_error);
  pass.time_s.pop_back();
  EXPECT_TRUE(std::isnan(scalars_of({s, pass}, "truth_").at("truth_e2_bound"))) << "only of a whole run";
}

/// Correct positions that were rounded to float32, ten metres from the origin, still pass.
TEST(ExactBounds, AllowsTheRoundingOfFloat32) {
  const Judged j(load_scene("validation/heavy-strip",
                            {"material.membrane_stiffness_N_per_m=1e6", "cloth.pose.center_m=[10,9.5,10]"}));
  EXPECT_EQ(j.verdict([&](int frame) {
    std::vector<double> x = j.exact[static_cast<std::size_t>(frame)];
    for (double& v : x) v = static_cast<float>(v);
    return x;
  }),
            "pass");
  EXPECT_TRUE(j.fails(crept(j.scene, 1e-5)));
}

// On which stiffness an exact solution depends; this decides whether a solver without that stiffness is ranked.

/// No list of scenes: the dependence of each solution on a stiffness is found by changing the stiffness.
TEST(Dependence, IsMeasuredOnEveryTruth) {
  const auto needs = [](const std::string& name, const std::vector<std::string>& set = {}) {
    const auto found = truth_dependence(load_scene("validation/" + name, set));
    const auto at_least = [&](const char* key) { return found.contains(key) && found.at(key) >= 0.01; };
    return std::string(at_least("truth_dependence_Y") ? "Y" : "") + (at_least("truth_dependence_B") ? "B" : "");
  };
  EXPECT_EQ(needs("heavy-strip"), "Y");
  EXPECT_EQ(needs("two-hand-pull"), "Y");
  EXPECT_EQ(needs("cantilever-10"), "B");
  for (const char* name : {"free-fall", "pendulum", "swing-strip", "incline-stick"}) EXPECT_EQ(needs(name), "") << name;
  // The strip's stretch is rho g L^2 / 2 Y: a tenth more stiffness gives an eleventh less stretch.
  const auto heavy = truth_dependence(load_scene("validation/heavy-strip"));
  EXPECT_NEAR(heavy.at("truth_dependence_Y"), (1 - 1 / 1.1) / std::log(1.1), 1e-6);
  EXPECT_EQ(needs("heavy-strip", {"material.membrane_stiffness_N_per_m=1e5"}), "Y") << "however little it stretches";
  EXPECT_TRUE(truth_dependence(load_scene("validation/hang")).empty()) << "no truth";
}

}  // namespace
}  // namespace clothbench

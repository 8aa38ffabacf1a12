// ReferenceCases: the exact solution of a scene, and a run's distance from it.
#include "truth/reference_case.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <cstdlib>

#include "clothbench/error.hpp"
#include "metrics/registry.hpp"
#include "metrics/truth_errors.hpp"
#include "refusal.hpp"
#include "runner/solver_run.hpp"
#include "scenario/load.hpp"
#include "solvers.hpp"

namespace clothbench {
namespace {

Scene scene(const std::string& name, const std::vector<std::string>& set = {}) {
  return load_scene("validation/" + name, set);
}

/// The exact solution as a run's state.
ClothState truth_state(const Scene& s, const truth::ReferenceCase& known, int frame) {
  return {truth::vertex_positions(s.cloth, known, frame), std::vector<double>(3 * s.cloth.vertex_count())};
}

void expect_no_distance_from_itself(const Scene& s) {
  const TruthJudge judge(s);
  const int last = s.time.frames();
  ClothState state = truth_state(s, judge.reference_case(), last);
  const TruthErrors e = judge.judge(last, state);
  EXPECT_EQ(e.e2, 0);
  EXPECT_NEAR(e.quantity_error, 0, 1e-12);
  EXPECT_NEAR(e.stretch_max, 0, 1e-12);
  for (std::size_t k = 1; k < state.position.size(); k += 3) state.position[k] += 0.01;
  EXPECT_NEAR(judge.judge(last, state).e2, 0.01 / std::max(s.cloth.width_m, s.cloth.height_m), 1e-9);
  state.position[4] = NAN;
  EXPECT_TRUE(std::isnan(judge.judge(last, state).e2));
  EXPECT_TRUE(std::isnan(judge.judge(last, state).quantity_error));
}

/// Attached vertices of the solution are at the scene's prescribed positions; moving solutions begin at its start.
void expect_agreement_with_the_scene(const Scene& s) {
  const auto known = truth::reference_case_of(s);
  ASSERT_TRUE(known);
  const std::vector<double> start = initial_positions(s), end = truth_state(s, *known, s.time.frames()).position;
  for (std::uint32_t v : s.pins.vertices)
    for (std::size_t k = 0; k < 3; ++k) EXPECT_NEAR(end[3 * v + k], start[3 * v + k], 1e-12) << v;
  for (std::size_t i = 0; i < s.grips.vertices.size(); ++i)
    for (std::size_t k = 0; k < 3; ++k)
      EXPECT_NEAR(end[3 * s.grips.vertices[i] + k], s.motion.back().grip_position_m[i][k], 1e-12);
  if (known->settles) return;
  const std::vector<double> first = truth_state(s, *known, 0).position;
  for (std::size_t k = 0; k < start.size(); ++k) EXPECT_NEAR(first[k], start[k], 1e-12);
}

TEST(ReferenceCases, AreNoDistanceFromThemselvesAndAgreeWithTheirScenes) {
  int cases = 0;
  for (const std::string& name : scene_names({"validation"})) {
    SCOPED_TRACE(name);
    const Scene s = load_scene(name);
    if (s.reference_case.empty()) continue;
    expect_no_distance_from_itself(s);
    expect_agreement_with_the_scene(s);
    ++cases;
  }
  EXPECT_GE(cases, 16);
}

/// The error is of order 2 in cell size. With 16 cells it also contains an interpolation error, because some of the
/// material points then lie between vertices; with 32 cells all are vertices.
TEST(SpaceError, FallsWithTheRun) {
  const double coarse = TruthJudge(scene("swing-strip", {"cloth.grid=[17,3]"})).space_error(),
               fine = TruthJudge(scene("swing-strip")).space_error();
  EXPECT_GT(coarse / fine, 2.5);
  EXPECT_LT(coarse / fine, 8);
  const Scene heavy = scene("heavy-strip"), fall = scene("free-fall");
  EXPECT_LT(TruthJudge(heavy).space_error(), 1e-12) << "rows of springs are exact at the rows";
  EXPECT_EQ(TruthJudge(fall).space_error(), 0);
}

/// Any triangulation of the rectangle has the same solution, with the continuum's columns.
TEST(MeshCases, DoNotDependOnTheTriangles) {
  for (const char* name : {"swing-strip-mesh", "heavy-strip-mesh", "cantilever-10-mesh"}) {
    const Scene coarse = scene(name, {"cloth.mesh.drawn.cells=9"}),
                fine = scene(name, {"cloth.mesh.drawn.cells=66", "cloth.mesh.drawn.turned_deg=70"});
    const int last = fine.time.frames();
    const auto a = truth::reference_case_of(coarse), b = truth::reference_case_of(fine);
    const Vec3 there = a->continuum(1, last);
    const Vec3 end = a->columns(last).back();
    for (std::size_t k = 0; k < 3; ++k) EXPECT_NEAR(end[k], there[k], 1e-12) << name << ": vertices lie on edge u1";
    if (coarse.reference_case == "cantilever") continue;  // its clamp is a cell wide
    EXPECT_NEAR(a->quantity(a->columns(last)), b->quantity(b->columns(last)), 0.02 * b->quantity_scale) << name;
    EXPECT_TRUE(std::isnan(TruthJudge(coarse).space_error())) << "a mesh has no exact solution of its own";
  }
}

/// Semi-implicit Euler with one step per frame lags g t dt/2 behind free fall: the expected error of `ballistic`.
TEST(TruthMetrics, BallisticIsBehindByItsOwnStep) {
  const Scene s = scene("free-fall");
  const SolverEntry& entry = find_solver("ballistic");
  SolverRun run({&s, &entry, nlohmann::json::object()}, {}, "test");
  AccuracyPass pass = whole_pass(run, s);
  ASSERT_EQ(run.outcome().status, "ok");
  const double dt = s.time.dt();
  std::vector<double> expected;
  for (const double t : pass.time_s) expected.push_back(0.5 * 9.81 * t * dt);
  for (const MetricSeries& m : pass.metrics) {
    if (m.name != "truth_error_e2") continue;
    for (std::size_t f = 0; f < expected.size(); ++f) EXPECT_NEAR(m.values[f], expected[f], 1e-12);
  }
  const auto summary = scalars_of({s, pass});
  EXPECT_NEAR(summary.at("truth_error"), truth::time_rms(pass.time_s, expected), 1e-12);
  EXPECT_NEAR(summary.at("truth_quantity"), 0.5 * 9.81 * (0.25 + 0.5 * dt), 1e-9);
  EXPECT_NEAR(summary.at("energy_gain"), 0, 0.1);
  pass.time_s.pop_back();
  EXPECT_TRUE(std::isnan(scalars_of({s, pass}).at("truth_error"))) << "a pass that broke off has no error";
}

/// A sheet with shear hangs like a strip, measured half a length away from the pinned edge, which keeps its width.
TEST(ReferenceCases, ASheetThatShearsNarrowsAsItStretches) {
  const Scene s = scene("heavy-strip", {"material.shear=true"}), rows = scene("heavy-strip");
  const auto sheet = truth::reference_case_of(s), strip = truth::reference_case_of(rows);
  const int last = s.time.frames();
  EXPECT_EQ(sheet->columns(last), strip->columns(last));
  EXPECT_NEAR(sheet->quantity_scale, 0.2 * 9.81 / (8 * 1000), 1e-15);
  const auto x = truth::vertex_positions(s.cloth, *sheet, last), y = truth::vertex_positions(rows.cloth, *strip, last);
  const std::size_t middle = 3 * 16;  // of the first row: half of the sheet hangs below it
  EXPECT_NEAR(x[middle + 2] - y[middle + 2], 0.2 * 9.81 * 0.5 / 1000 / 3 * 0.0625, 1e-15);
  EXPECT_EQ(x[0], y[0]);
}

TEST(ReferenceCases, RefuseScenesTheyDoNotAnswer) {
  const auto refused = [](const std::string& name, const std::string& set, const std::string& why) {
    EXPECT_PRED2(mentions, refusal([&] { truth::reference_case_of(scene(name, {set})); }), why) << name;
  };
  refused("swing-strip", "material.shear=true", "/truth/case: \"swing-strip\" requires \"shear\": false");
  refused("swing-strip", "time.duration_s=2", "chaotic");
  refused("swing-strip", "material.damping_per_s=1", "no damping");
  refused("heavy-strip", "material.damping_per_s=0", "damping, to come to rest");
  refused("cantilever-10", "material.membrane_stiffness_N_per_m=1000", "1e-7");
  refused("two-hand-pull", "grips.0.ramp_s=0.01", "one ramp_s");
  refused("free-fall", "pins=[{\"edge\":\"u0\"}]", "no pins and no grips");
  refused("swing-strip-mesh", "material.membrane_stiffness_N_per_m=1000", "1e-3");
  refused("swing-strip-mesh", "truth.case=two-hand-pull", "a grid cloth");
  refused("swing-strip-mesh", "cloth.mesh.drawn.size_m=[0.125,1]", "longer side along x");
  refused("swing-strip-mesh", "pins=[{\"group\":\"v0\"}]", "edge u0 pinned");
  refused("cantilever-10-mesh", "pins=[{\"group\":\"u0\"}]", "less than half of the width");
  refused("cantilever-10-mesh", "pins=[{\"group\":\"u0\"},{\"nearest_m\":[[-0.08,0,0]]}]", "end of the clamp");
  refused("incline-stick", "colliders.0.margin_m=0.01", "at the collider's margin");
  refused("incline-stick", "colliders.0.size_m=[0.2,0.1,1]", "under the whole sheet");
  refused("incline-stop", "colliders.0.size_m=[0.3,0.1,1]", "under the whole path of the sheet");
  refused("incline-slip", "cloth.initial_velocity_m_per_s=[0,0,1]", "straight downhill");
  refused("incline-slip", "material.damping_per_s=1", "no damping");
  refused("capstan-hold", "cloth.grid=[43,5]", "lie evenly");
  refused("capstan-hold", "material.membrane_stiffness_N_per_m=1000", "inextensible");
  refused("capstan-hold", "colliders.0.radius_m=0.09", "drape radius");
  refused("capstan-hold", "colliders.0.friction=0", "friction");
  const Scene half = scene("swing-strip", {"gravity_m_per_s2=[0,-4.905,0]", "cloth.size_m=[0.5,0.0625]"});
  EXPECT_TRUE(truth::reference_case_of(half)) << "any parameter will do";
  EXPECT_EQ(truth::reference_case_of(scene("incline-stick", {"gravity_m_per_s2=[0,-1.6,0]"}))->quantity_scale, 0.25);
}

TEST(ReferenceCases, TurnFromSlippingToHoldingAtTheClosedForm) {
  const auto moves = [](const std::string& name, double friction, const std::string& with) {
    const Scene s = scene(name, {"colliders.0.friction=" + std::to_string(friction), with});
    const auto known = truth::reference_case_of(s);
    return std::abs(known->quantity(known->columns(s.time.frames()))) > 1e-9;
  };
  const double critical = std::tan(16 * 3.14159265358979 / 180);
  EXPECT_TRUE(moves("incline-stick", critical - 1e-5, "time.duration_s=2"));
  EXPECT_FALSE(moves("incline-stick", critical + 1e-5, "time.duration_s=2"));
  EXPECT_TRUE(moves("capstan-hold", 0.225, "time.duration_s=0.4"));
  EXPECT_FALSE(moves("capstan-hold", 0.23, "time.duration_s=0.4"));
}

TEST(Span, TheArcHangsAndItsRunsKeepTheirLengths) {
  const std::string name = "stability/s16-gravity";
  const Scene s = load_scene(name);
  const std::vector<double> x = initial_positions(s);
  const Cloth& c = s.cloth;
  double lowest = 0;
  for (int i = 0; i + 1 < c.columns; ++i) {
    const auto a = static_cast<std::size_t>(3 * i);
    EXPECT_NEAR(std::hypot(x[a + 3] - x[a], x[a + 4] - x[a + 1]), c.du(), 1e-14);
    lowest = std::min(lowest, x[a + 1]);
  }
  EXPECT_NEAR(x[static_cast<std::size_t>(3 * (c.columns - 1))] - x[0], 0.8, 1e-12);
  EXPECT_NEAR(x[1], 0, 1e-12);
  EXPECT_LT(lowest, -0.2);
  EXPECT_THROW(load_scene(name, {"cloth.pose.span_m=1.0"}), Error);
  EXPECT_THROW(load_scene(name, {"cloth.grid=[2,2]"}), Error);
}

// The order in time that a solver declares for its integrator, observed on the pendulum.

constexpr int kIterations = 64;  // converged, so that only the integrator's error remains

bool has(const SolverInfo& info, const char* setting) {
  for (const SettingSpec& s : info.settings)
    if (s.name == setting) return true;
  return false;
}

class Order : public ::testing::TestWithParam<std::string> {};

std::vector<std::string> names() {
  std::vector<std::string> out;
  for (const SolverEntry& e : solvers())
    if (e.info.ignores.empty() && has(e.info, "substeps")) out.push_back(e.info.name);
  return out;
}

INSTANTIATE_TEST_SUITE_P(Every, Order, ::testing::ValuesIn(names()), [](const auto& i) { return test_name(i.param); });

double truth_error(const Scene& s, const SolverEntry& entry, int substeps) {
  nlohmann::json given = {{"substeps", substeps}};
  if (has(entry.info, "iterations")) given["iterations"] = kIterations;
  if (has(entry.info, "implicit")) given["implicit"] = true;
  SolverRun run({&s, &entry, complete_settings(entry.info, given)}, {}, "test");
  const AccuracyPass pass = whole_pass(run, s);
  EXPECT_EQ(run.outcome().status, "ok");
  return scalars_of({s, pass}).at("truth_error");
}

TEST_P(Order, IsAsDeclared) {
  const SolverEntry& entry = find_solver(GetParam());
  const Scene s = load_scene("validation/pendulum");
  if (!unsupported(entry.info, s.needs).empty()) GTEST_SKIP() << "unsupported";
  try {
    const double e1 = truth_error(s, entry, 4), e2 = truth_error(s, entry, 8), e3 = truth_error(s, entry, 16);
    EXPECT_NEAR(std::log2(e1 / e2), entry.info.time_order, 0.25) << e1 << " " << e2 << " " << e3;
    EXPECT_NEAR(std::log2(e2 / e3), entry.info.time_order, 0.25) << e1 << " " << e2 << " " << e3;
    EXPECT_LT(e3, 0.01);
  } catch (const Error& e) {
    if (may_lack_device(e)) GTEST_SKIP() << e.what();
    FAIL() << e.what();
  }
}

}  // namespace
}  // namespace clothbench

// Sheets with uneven cells or masses, or a start away from rest; frames of unequal length; hands that jump.
#include <gtest/gtest.h>

#include <cmath>
#include <numeric>

#include "base/json_text.hpp"
#include "refusal.hpp"
#include "runner/solver_run.hpp"
#include "scenario/load.hpp"
#include "solvers.hpp"

namespace clothbench {
namespace {

using nlohmann::json;

Scene load(const std::vector<std::string>& set) {
  static const json base = json::parse(
      R"({"name": "uneven", "why": "an uneven sheet in a test", "cloth": {"grid": [5, 3], "size_m": [1, 0.5],
    "areal_density_kg_per_m2": 0.2, "sides": "single"}, "material": {"membrane_stiffness_N_per_m": 1000}, "time": {"frame_rate_hz": 60, "duration_s": 0.5}})");
  return scene_from_json(base, "test", set);
}
double total(const std::vector<double>& v) { return std::accumulate(v.begin(), v.end(), 0.0); }

TEST(Regular, NeedsNothingNew) {
  const Scene s = load({});
  for (Feature f : {Feature::UnevenGrid, Feature::Regions, Feature::Spin}) EXPECT_FALSE(s.needs.has(f));
  EXPECT_EQ(s.json.find("start"), std::string::npos);  // unused features are not in the scene's JSON
  EXPECT_EQ(s.json.find("stability"), std::string::npos);
}

TEST(Columns, FillTheWidthAndKeepTheMass) {
  const Scene s = load({R"(cloth.column_factors=[{"column": 1, "factor": 0.001}])"});
  EXPECT_TRUE(s.needs.has(Feature::UnevenGrid));
  EXPECT_NEAR(s.cloth.line_u_m(2) - s.cloth.line_u_m(1), 0.001 / 3.001, 1e-12);
  EXPECT_EQ(s.cloth.line_u_m(4), 1);
  EXPECT_NEAR(total(vertex_masses(s)), 0.2 * 0.5, 1e-12);
  const Edge narrow = edges(s.cloth, EdgeKind::Structural)[1];
  EXPECT_NEAR(narrow.rest_m, 0.001 / 3.001, 1e-12);
  const std::vector<double> x = initial_positions(s);
  EXPECT_NEAR(x[3 * narrow.b] - x[3 * narrow.a], narrow.rest_m, 1e-12);
}

TEST(Columns, OfWidthZeroHaveNoLength) {
  const Scene s = load({R"(cloth.column_factors=[{"column": 1, "factor": 0}])"});
  EXPECT_EQ(edges(s.cloth, EdgeKind::Structural)[1].rest_m, 0);
  for (double m : vertex_masses(s)) EXPECT_GT(m, 0);
}

TEST(Masses, AreScaledWhereTold) {
  const Scene even = load({}),
              s = load({R"(cloth.mass_factors=[{"edge": "u1", "factor": 1000}, {"vertices": [6], "factor": 0.0001}])"});
  const auto a = vertex_masses(even), b = vertex_masses(s);
  for (std::size_t v = 0; v < a.size(); ++v)
    EXPECT_DOUBLE_EQ(b[v], a[v] * (v % 5 == 4 ? 1000 : v == 6 ? 1e-4 : 1)) << v;
}

TEST(Regions, ChangeTheStiffnessOfTheirColumns) {
  const Scene s = load({R"(material.regions=[{"columns": [2, 3], "membrane_stiffness_N_per_m": 1e6}])"});
  EXPECT_TRUE(s.needs.has(Feature::Regions));
  const auto along_u = edges(s.cloth, EdgeKind::Structural);
  EXPECT_EQ(membrane_stiffness(s, along_u[1]), 1000);
  EXPECT_EQ(membrane_stiffness(s, along_u[2]), 1e6);
  for (const Edge& e : along_u)
    if (e.b == e.a + 5 && e.a == 2) {  // on the line between both
      EXPECT_EQ(membrane_stiffness(s, e), (1000 + 1e6) / 2);
    }
}

TEST(Starts, AreSeededAndLeaveWhatIsPinned) {
  const std::vector<std::string> set = {R"(pins=[{"edge": "u0"}])",
                                        R"(cloth.start={"shape": "sphere", "radius_m": 0.7, "seed": 3})"};
  const Scene s = load(set);
  const std::vector<double> x = initial_positions(s), again = initial_positions(load(set));
  EXPECT_EQ(x, again);
  std::vector<std::string> other = set;
  other.push_back("cloth.start.seed=4");
  EXPECT_NE(x, initial_positions(load(other)));
  for (std::size_t v = 0; v < 15; ++v) {
    if (v % 5 == 0) {
      EXPECT_NEAR(x[3 * v], -0.5, 1e-15);
      continue;
    }
    EXPECT_NEAR(std::hypot(x[3 * v], x[3 * v + 1], x[3 * v + 2]), 0.7, 1e-12);
  }
}

TEST(Starts, SquashFoldMergeAndMove) {
  for (double value : initial_positions(load({R"(cloth.start={"shape": "point"})"}))) EXPECT_EQ(value, 0);
  const auto line = initial_positions(load({R"(cloth.start={"shape": "line"})"}));
  for (std::size_t v = 0; v < 15; ++v) EXPECT_EQ(line[3 * v + 2], 0);
  const auto folded = initial_positions(load({R"(cloth.start={"shape": "folded", "folds": 4})"}));
  for (std::size_t v = 0; v < 5; ++v) EXPECT_NEAR(folded[3 * v], v % 2 == 0 ? -0.5 : -0.25, 1e-12);
  const auto merged = initial_positions(load({R"(cloth.start={"shape": "rest", "merge": [[2, 7, 12]]})"}));
  for (std::size_t k = 0; k < 3; ++k) EXPECT_EQ(merged[3 * 12 + k], merged[3 * 2 + k]);
  const auto moved = initial_positions(load(
      {R"(pins=[{"edge": "u0"}])", R"(cloth.start={"shape": "rest", "move": [{"edge": "u0", "by_m": [0, 2, 0]}]})"}));
  EXPECT_EQ(moved[1], 2);
}

TEST(Starts, NoiseHasItsDeviation) {
  const Scene s = load({"cloth.grid=[64,64]", R"(cloth.start={"shape": "rest", "noise_m": 0.001})"});
  const auto x = initial_positions(s), rest = initial_positions(load({"cloth.grid=[64,64]"}));
  double squares = 0;
  for (std::size_t k = 0; k < x.size(); ++k) squares += (x[k] - rest[k]) * (x[k] - rest[k]);
  EXPECT_NEAR(std::sqrt(squares / static_cast<double>(x.size())), 0.001, 3e-5);
}

TEST(Spin, TurnsAboutTheCentre) {
  const Scene s = load({"cloth.spin_rad_per_s=[0,2,0]", "cloth.initial_velocity_m_per_s=[0,1,0]"});
  EXPECT_TRUE(s.needs.has(Feature::Spin));
  const auto v = initial_velocities(s);
  EXPECT_NEAR(v[2], 1.0, 1e-12);  // x = -1/2, so omega x r has z = +1
  EXPECT_NEAR(v[1], 1.0, 1e-12);
}

TEST(Frames, JitterStaysInItsShare) {
  const Scene s = load({R"(time.jitter={"share": 0.5, "seed": 2})"});
  double least = 1, most = 0;
  for (int f = 0; f < s.time.frames(); ++f) {
    least = std::min(least, s.time.dt_after(f) * 60);
    most = std::max(most, s.time.dt_after(f) * 60);
  }
  EXPECT_GE(least, 0.5);
  EXPECT_LT(least, 0.6);
  EXPECT_LE(most, 1.5);
  EXPECT_GT(most, 1.4);
}

TEST(Hands, StopLetGoAndJump) {
  const Scene s = load(
      {R"(grips=[{"edge": "u1", "velocity_m_per_s": [1, 0, 0], "stop_s": 0.1, "release_s": 0.3, "jumps": [{"time_s": 0.2, "by_m": [0, 0.5, 0]}]}])"});
  const auto at = [&](int f) { return s.motion[static_cast<std::size_t>(f)]; };
  EXPECT_NEAR(at(6).grip_position_m[0][0], 0.6, 1e-12);
  EXPECT_NEAR(at(12).grip_position_m[0][0], 0.6, 1e-12);
  EXPECT_EQ(at(12).grip_position_m[0][1], 0);
  EXPECT_EQ(at(13).grip_position_m[0][1], 0.5);
  ASSERT_EQ(s.jumps.size(), 1u);
  EXPECT_EQ(s.jumps[0].frame, 13);
  EXPECT_EQ(s.jumps[0].distance_m, 0.5);
  EXPECT_EQ(at(17).grip_held[0], 1);
  EXPECT_EQ(at(18).grip_held[0], 0);
}

TEST(Capsules, MoveJumpAndTurn) {
  const Scene s = load(
      {R"(colliders=[{"type": "capsule", "center_m": [0, 1, 0], "radius_m": 0.1, "length_m": 0.4, "velocity_m_per_s": [0, -1, 0], "start_s": 0.1, "spin_rad_per_s": [0, 0, 3.141592653589793], "jumps": [{"time_s": 0, "by_m": [0, 0, 2]}]}])"});
  EXPECT_TRUE(s.needs.has(Feature::Capsules));
  const Capsule end = s.motion.back().colliders[0].capsules[0];  // half a turn per second, for half a second
  EXPECT_NEAR(end.a_m[0], 0, 1e-12);
  EXPECT_NEAR(end.b_m[1] - end.a_m[1], 0.4, 1e-12);
  EXPECT_NEAR((end.a_m[1] + end.b_m[1]) / 2, 0.6, 1e-12);
  EXPECT_NEAR(end.a_m[2], 2, 1e-12);
}

TEST(Irregular, WhatIsWrongIsNamed) {
  const struct {
    std::vector<std::string> set;
    const char* complaint;
  } refused[] = {
      {{R"(cloth.column_factors=[{"column": 4, "factor": 2}])"}, "/cloth/column_factors/0/column"},
      {{R"(cloth.column_factors=[{"column": 0, "factor": 0}])"}, "no mass"},
      {{R"(cloth.mass_factors=[{"edge": "u1", "factor": 0}])"}, "/cloth/mass_factors/0/factor"},
      {{R"(cloth.mass_factors=[{"vertices": [15], "factor": 2}])"}, "vertex 15 of 15"},
      {{R"(cloth.mass_factors=[{"factor": 2}])"}, "expected \"edge\", \"group\" or \"vertices\""},
      {{R"(material.regions=[{"columns": [2, 4], "membrane_stiffness_N_per_m": 1}])"}, "/material/regions/0/columns"},
      {{R"(time.hitch={"frame": 30, "dt_s": 0.25})"}, "/time/hitch/frame"},
      {{R"(pins=[{"edge": "u0"}])", R"(grips=[{"edge": "u0", "velocity_m_per_s": [1, 0, 0]}])"}, "is pinned as well"},
      {{R"(grips=[{"edge": "u0", "velocity_m_per_s": [1, 0, 0]}, {"edge": "v0", "velocity_m_per_s": [0, 1, 0]}])"},
       "held by two hands"},
  };
  for (const auto& r : refused) EXPECT_PRED2(mentions, refusal([&] { load(r.set); }), r.complaint);
}

// Degenerate input that is accepted: every solver that supports its features must simulate it sensibly (table in
// scenarios/stability/README.md; tests/scenario/load_test.cpp has the refused input).

const char* const kSheet = R"({"name": "sheet", "why": "a sheet of bad input",
  "cloth": {"grid": [5, 4], "size_m": [0.4, 0.3], "areal_density_kg_per_m2": 0.2, "sides": "single", "pose": {"center_m": [0, 0.05, 0], "axis_u": [1, 0, 0], "axis_v": [0, 0, 1]}},
  "material": {"membrane_stiffness_N_per_m": 1000, "damping_per_s": 1}, "time": {"frame_rate_hz": 60, "duration_s": 0.25}})";

/// A floor of two triangles around (0, 0, 0), and further triangles.
std::string mesh(const std::string& positions, const std::string& triangles) {
  return R"(colliders=[{"type": "mesh", "positions_m": [[-1, 0, -1], [-1, 0, 1], [1, 0, 1], [1, 0, -1])" + positions +
         R"(], "triangles": [[0, 1, 2], [0, 2, 3])" + triangles + "]}]";
}

struct Case {
  const char* name;  ///< of the input and of the test
  std::vector<std::string> set;
};

void PrintTo(const Case& c, std::ostream* out) { *out << c.name; }

std::vector<Case> cases() {
  const std::string flipped = mesh("", ", [0, 2, 1]"), twice = mesh("", ", [0, 1, 2]"),
                    doubled = mesh(", [-1, 0, -1], [1, 0, 1]", ", [4, 1, 5]"),
                    flat = mesh("", ", [0, 0, 2], [1, 1, 1]"),
                    fan = mesh(", [0, 1, 0.5], [0.5, -1, 0]", ", [0, 2, 4], [0, 2, 5]");
  return {
      {"all pinned",
       {R"(pins=[{"edge":"u0"},{"edge":"u1"},{"edge":"v0"},{"edge":"v1"},{"vertices":[6,7,8,11,12,13]}])"}},
      {"zero-area cells", {R"(cloth.column_factors=[{"column":1,"factor":0}])"}},
      {"duplicate vertices", {R"(cloth.start={"shape":"rest","merge":[[6,7,8],[0,19]]})"}},
      {"all vertices at a point", {R"(cloth.start={"shape":"point"})"}},
      {"inverted cells",
       {R"(cloth.start={"shape":"rest","move":[{"vertices":[6],"by_m":[0.25,0,0]}]})", R"(pins=[{"edge":"u0"}])"}},
      {"collider with inverted triangles", {flipped}},
      {"collider with duplicate faces", {twice}},
      {"collider with duplicate vertices", {doubled}},
      {"collider with triangles without area", {flat}},
      {"non-manifold collider", {fan}},
  };
}

class BadInput : public ::testing::TestWithParam<Case> {};

/// Solvers under this project's responsibility. The others are baselines: they may blow up, but must not break the run.
bool is_ours(const SolverInfo& info) { return info.name == "xpbd" || info.name == "reference"; }

void expect_sane(const Scene& scene, const SolverEntry& entry) {
  if (!entry.make || !unsupported(entry.info, scene.needs).empty()) return;
  if (entry.info.on_gpu && (!entry.devices || entry.devices().empty())) {
    EXPECT_TRUE(may_lack_device(Error("no device", ExitCode::NoDevice))) << "no device for " << entry.info.name;
    return;
  }
  SCOPED_TRACE(entry.info.name);
  const std::unique_ptr<ClothSolver> solver = entry.make(complete_settings(entry.info, {}), {});
  solver->load(scene);
  const std::vector<double> start = initial_positions(scene);
  for (int f = 0; f < scene.time.frames(); ++f) {
    const StepStatus status = solver->step({f, scene.time.at(f + 1), scene.time.dt_after(f), scene.motion_after(f)});
    // The reference's Newton iteration may report that it found no solution, which is not a wrong solution.
    const bool gave_up =
        entry.info.name == "reference" && (status == StepStatus::Diverged || status == StepStatus::NotFinite);
    ASSERT_TRUE(status == StepStatus::Ok || gave_up || !is_ours(entry.info)) << "frame " << f;
    if (status != StepStatus::Ok) return;
  }
  ClothState state;
  solver->read_state(state);
  ASSERT_EQ(state.position.size(), start.size());
  if (!is_ours(entry.info)) return;
  for (std::size_t k = 0; k < start.size(); ++k) {
    ASSERT_TRUE(std::isfinite(state.position[k]) && std::isfinite(state.velocity[k])) << "vertex " << k / 3;
    // A quarter of a second of free fall is 0.31 m; the sheet is 0.5 m across.
    ASSERT_LE(std::abs(state.position[k] - start[k]), 1.5) << "vertex " << k / 3;
  }
  for (const std::uint32_t v : scene.pins.vertices)
    for (std::size_t k = 3 * v; k < 3 * v + 3; ++k)
      EXPECT_NEAR(state.position[k], start[k], 1e-6) << "pinned vertex " << v;
}

TEST_P(BadInput, IsSimulatedSanely) {
  const Scene scene = scene_from_json(parse_json(kSheet, "sheet.json"), "sheet.json", GetParam().set);
  int ran = 0;
  for (const SolverEntry& entry : solvers()) {
    expect_sane(scene, entry);
    ran += entry.make && unsupported(entry.info, scene.needs).empty() && is_ours(entry.info);
  }
  EXPECT_GE(ran, 1) << "no solver ran this";
}

INSTANTIATE_TEST_SUITE_P(Cases, BadInput, ::testing::ValuesIn(cases()),
                         [](const auto& p) { return test_name(p.param.name); });

}  // namespace
}  // namespace clothbench

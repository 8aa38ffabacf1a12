// Degenerate input that is not refused: every solver that claims what it needs simulates it sanely (table in
// scenarios/stability/README.md; tests/scenario/load_test.cpp has what is refused).
#include <gtest/gtest.h>

#include <cmath>
#include <cstdlib>

#include "base/json_text.hpp"
#include "refusal.hpp"
#include "runner/solver_run.hpp"
#include "scenario/load.hpp"

namespace clothbench {
namespace {

using nlohmann::json;

const char* const kSheet = R"({"name": "sheet", "why": "a sheet of bad input",
  "cloth": {"grid": [5, 4], "size_m": [0.4, 0.3], "areal_density_kg_per_m2": 0.2, "sides": "single", "pose": {"center_m": [0, 0.05, 0], "axis_u": [1, 0, 0], "axis_v": [0, 0, 1]}},
  "material": {"membrane_stiffness_N_per_m": 1000, "damping_per_s": 1}, "time": {"frame_rate_hz": 60, "duration_s": 0.25}})";

/// A floor of two triangles round (0, 0, 0), and more of them.
std::string mesh(const std::string& positions, const std::string& triangles) {
  return R"(colliders=[{"type": "mesh", "positions_m": [[-1, 0, -1], [-1, 0, 1], [1, 0, 1], [1, 0, -1])" + positions +
         R"(], "triangles": [[0, 1, 2], [0, 2, 3])" + triangles + "]}]";
}

struct Case {
  const char* name;  ///< of the input, also of the test
  std::vector<std::string> set;
};

const std::vector<Case>& cases() {
  static const std::string flipped = mesh("", ", [0, 2, 1]"), twice = mesh("", ", [0, 1, 2]"),
                           doubled = mesh(", [-1, 0, -1], [1, 0, 1]", ", [4, 1, 5]"),
                           flat = mesh("", ", [0, 0, 2], [1, 1, 1]"),
                           fan = mesh(", [0, 1, 0.5], [0.5, -1, 0]", ", [0, 2, 4], [0, 2, 5]");
  static const std::vector<Case> all = {
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
  return all;
}

class BadInput : public ::testing::TestWithParam<std::size_t> {};

/// Those that the project answers for. Others are baselines, shown as they are: they may blow up, not break the run.
bool is_ours(const SolverInfo& info) { return info.name == "xpbd" || info.name == "reference"; }

void expect_sane(const Scene& scene, const SolverEntry& entry) {
  if (!entry.make || !unsupported(entry.info, scene.needs).empty()) return;
  if (entry.info.on_gpu && (!entry.devices || entry.devices().empty())) {
    const char* allowed = std::getenv("CLOTHBENCH_ALLOW_NO_DEVICE");
    EXPECT_TRUE(allowed != nullptr && std::string(allowed) == "1") << "no device for " << entry.info.name;
    return;
  }
  SCOPED_TRACE(entry.info.name);
  const std::unique_ptr<ClothSolver> solver = entry.make(complete_settings(entry.info, {}), {});
  solver->load(scene);
  const std::vector<double> start = initial_positions(scene);
  for (int f = 0; f < scene.time.frames(); ++f) {
    const StepStatus status = solver->step({f, scene.time.at(f + 1), scene.time.dt_after(f), scene.motion_after(f)});
    // The reference's Newton may say that it has found no solution; that is no wrong one.
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
  const Scene scene = scene_from_json(parse_json(kSheet, "sheet.json"), "sheet.json", cases()[GetParam()].set);
  int ran = 0;
  for (const SolverEntry& entry : solvers()) {
    expect_sane(scene, entry);
    ran += entry.make && unsupported(entry.info, scene.needs).empty() && is_ours(entry.info);
  }
  EXPECT_GE(ran, 1) << "no solver ran this";
}

INSTANTIATE_TEST_SUITE_P(Cases, BadInput, ::testing::Range<std::size_t>(0, cases().size()),
                         [](const auto& p) { return test_name(cases()[p.param].name); });

}  // namespace
}  // namespace clothbench

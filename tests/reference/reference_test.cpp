// The reference solver against closed forms and minimal-coordinate chains, and its two integrators against each other.
#include <gtest/gtest.h>

#include <cmath>
#include <nlohmann/json.hpp>

#include "clothbench/solver.hpp"
#include "scenario/load.hpp"
#include "sheets.hpp"

namespace clothbench {
namespace {

using nlohmann::json;

Scene strip(int cells, double duration_s, const json& patch = json::object()) {
  json s = {{"name", "strip"},
            {"why", "a strip for the tests"},
            {"cloth",
             {{"grid", {cells + 1, 2}},
              {"size_m", {1.0, 1.0 / cells}},
              {"areal_density_kg_per_m2", 0.2},
              {"sides", "single"},
              {"pose", {{"center_m", {0.5, 0, 0}}}}}},
            {"material", {{"membrane_stiffness_N_per_m", "inextensible"}, {"shear", false}}},
            {"pins", {{{"edge", "u0"}}}},
            {"time", {{"frame_rate_hz", 60}, {"duration_s", duration_s}}}};
  s.merge_patch(patch);
  return scene_from_json(s, "strip");
}

ClothState run(const Scene& scene, const std::string& integrator, int substeps) {
  const SolverEntry& e = find_solver("reference");
  auto solver = e.make(complete_settings(e.info, {{"substeps", substeps}, {"integrator", integrator}}), {});
  solver->load(scene);
  return after(*solver, scene, scene.time.frames());
}

/// x and height of the tip (last vertex of the first row).
std::pair<double, double> tip(const Scene& s, const ClothState& state) {
  const auto i = static_cast<std::size_t>(3 * (s.cloth.columns - 1));
  return {state.position[i], state.position[i + 1]};
}

class Integrators : public ::testing::TestWithParam<const char*> {};
INSTANTIATE_TEST_SUITE_P(Both, Integrators, ::testing::Values("bdf2", "conservative"));

/// A chain of 8 links with half an end mass, released level: at 0.3 s its tip is at (0.794901, -0.441450) [m]
/// (minimal-coordinate chain, Dormand-Prince 8(5,3), two tolerances agree to 1e-9).
TEST_P(Integrators, SwingConvergesWithOrderTwoToTheChain) {
  const Scene s = strip(8, 0.3);
  const auto [x1, y1] = tip(s, run(s, GetParam(), 8));
  const auto [x2, y2] = tip(s, run(s, GetParam(), 16));
  const auto [x3, y3] = tip(s, run(s, GetParam(), 32));
  const double order = std::log2((x1 - x2) / (x2 - x3));
  EXPECT_NEAR(order, 2, 0.25);
  EXPECT_NEAR(x3 + (x3 - x2) / 3, 0.794901, 2e-6);
  EXPECT_NEAR(y3 + (y3 - y2) / 3, -0.441450, 2e-6);
}

TEST_P(Integrators, FreeFallIsItsOwnRecurrence) {
  const Scene s = strip(
      4, 0.25, {{"pins", json::array()}, {"material", {{"membrane_stiffness_N_per_m", 1000}, {"damping_per_s", 0.7}}}});
  const SolverEntry& e = find_solver("reference");
  const json settings = complete_settings(e.info, {{"substeps", 4}, {"integrator", GetParam()}});
  const auto [x, y] = tip(s, run(s, GetParam(), 4));
  EXPECT_NEAR(y, e.free_fall_m(s, settings, s.time.frames()), 1e-10);
  EXPECT_NEAR(x, 1, 1e-10);
}

TEST(Reference, RepeatsAFrameWithoutSolutionWithShorterSteps) {
  const Scene s = load_scene("paper/two-hand-stretch-10mps", {"cloth.grid=[5,5]", "time.duration_s=1.1"});
  EXPECT_LT(std::abs(tip(s, run(s, "bdf2", 1)).first), 0.5) << "frame 77, in which the hands let go, has no solution";
}

TEST_P(Integrators, HeldVerticesFollowTheHandAndLetGo) {
  const Scene s = load_scene("paper/two-hand-stretch-0p5mps", {"cloth.grid=[5,5]", "time.duration_s=1.4"});
  const SolverEntry& e = find_solver("reference");
  auto solver = e.make(complete_settings(e.info, {{"substeps", 2}, {"integrator", GetParam()}}), {});
  solver->load(s);
  ClothState state;
  for (int f = 0; f < s.time.frames(); ++f) {
    state = after_frame(*solver, s, f);
    for (std::size_t k = 0; k < s.grips.vertices.size(); ++k) {
      if (s.motion[static_cast<std::size_t>(f)].grip_held[k] == 0) continue;
      for (std::size_t c = 0; c < 3; ++c)
        EXPECT_NEAR(state.position[3 * s.grips.vertices[k] + c], s.motion_after(f)->grip_position_m[k][c], 1e-12);
    }
  }
  EXPECT_LT(state.position[3 * s.grips.vertices[0] + 1], s.motion.back().grip_position_m[0][1] - 0.01);
}

TEST(Reference, RefusesBadSettings) {
  const SolverEntry& e = find_solver("reference");
  for (const json& bad : {json{{"integrator", "leapfrog"}}, json{{"substeps", 0}}, json{{"tolerance", 0.0}}})
    EXPECT_ANY_THROW(e.make(complete_settings(e.info, bad), {})) << bad.dump();
}

}  // namespace
}  // namespace clothbench

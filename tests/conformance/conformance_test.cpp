// One body x every registered solver x every scene: what any backend must do, whatever its method.
#include <gtest/gtest.h>

#include <cmath>
#include <cstdlib>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <numeric>
#include <ostream>

#include "clothbench/error.hpp"
#include "clothbench/solver.hpp"
#include "runner/frame_input.hpp"
#include "runner/stage_check.hpp"
#include "scenario/load.hpp"
#include "scenario/study.hpp"

namespace clothbench {
namespace {

namespace fs = std::filesystem;

struct Case {
  std::string solver, scene, sides, grid, profile;
};

void PrintTo(const Case& c, std::ostream* out) { *out << c.solver << " on " << c.scene; }

/// Every scene with every kind of sides and every grid; all their combinations in the slow tier.
bool chosen(const std::string& scene, std::size_t sides, std::size_t grid) {
  if (CLOTHBENCH_ALL_CASES) return true;
  const auto shift = std::accumulate(scene.begin(), scene.end(), std::size_t{0}, [](std::size_t n, char c) { return n + static_cast<unsigned char>(c); });
  return (sides + grid + shift) % 3 == 0;
}

std::vector<Case> cases() {
  const char *const sides[] = {"single", "double-duplicated", "double"}, *const grids[] = {"[2,2]", "[9,7]", "[17,33]"};  // not multiples of any workgroup
  std::vector<Case> all;
#ifdef CLOTHBENCH_PLUGIN_UNDER_TEST
  const std::vector<SolverEntry> under_test = {find_solver("plugin:" CLOTHBENCH_PLUGIN_UNDER_TEST)};
#else
  const std::vector<SolverEntry>& under_test = solvers();
#endif
  for (const SolverEntry& e : under_test)
    for (const auto& file : fs::recursive_directory_iterator(CLOTHBENCH_SOURCE_DIR "/scenarios")) {
      fs::path relative = fs::relative(file.path(), CLOTHBENCH_SOURCE_DIR "/scenarios");
      const std::string folder = relative.begin()->string();
      if (folder == "stability") continue;  // they name vertices of their own grids, and are there to fail
      if (file.path().extension() != ".json" || folder == "schema" || folder == "studies" || folder == "assets") continue;
      const std::string scene = relative.replace_extension().string();
      for (std::size_t side = 0; side < 3; ++side)
        for (std::size_t grid = 0; grid < 3; ++grid)
          for (const char* profile : {"", "adreno-like"})
            if (chosen(scene, side, grid) && (*profile == '\0' || (e.info.on_gpu && grid == 2)))
              all.push_back({e.info.name, scene, sides[side], grids[grid], profile});
    }
  return all;
}

std::string case_name(const ::testing::TestParamInfo<Case>& info) {
  std::string name = info.param.solver + "_" + info.param.scene + "_" + info.param.sides + "_" + info.param.grid +
                     (info.param.profile.empty() ? "" : "_" + info.param.profile);
  for (char& c : name)
    if (!std::isalnum(static_cast<unsigned char>(c))) c = '_';
  return name;
}

class Conformance : public ::testing::TestWithParam<Case> {
 protected:
  void SetUp() override {
    const Case& c = GetParam();
    std::vector<std::string> overrides = {"cloth.sides=" + c.sides, "cloth.grid=" + c.grid};
    // Four vertices have none near a hand.
    if (c.grid == "[2,2]" && c.scene.find("stretch") != std::string::npos)
      for (const char* hand : {"0", "1"}) overrides.push_back(std::string("grips.") + hand + ".radius_m=0.6");
    if (c.grid == "[2,2]" && c.scene.find("catenary") != std::string::npos) overrides.back() = "cloth.grid=[3,2]";  // 2 columns cannot bend
    // A strip that starts over a cylinder needs cells shorter than it is thick.
    if (c.grid != "[17,33]" && (c.scene.find("capstan") != std::string::npos || c.scene.find("atwood") != std::string::npos ||
                                c.scene.find("self-fold") != std::string::npos))
      overrides.back() = c.grid == "[2,2]" ? "cloth.grid=[17,2]" : "cloth.grid=[17,7]";
    if (load_scene(c.scene).cloth.mesh) overrides.pop_back();  // a mesh has one size
    scene_ = load_scene(c.scene, overrides);
    entry_ = &find_solver(c.solver);
    // Its constraints are exact: a sheet with inextensible diagonals too has more of them than ways to move.
    if (c.solver == "reference" && !scene_.material.membrane_stiffness_N_per_m && (scene_.needs.has(Feature::Shear) || scene_.cloth.mesh))
      GTEST_SKIP() << "diverges: over-determined";
    try {
      solver_ = entry_->make(complete_settings(entry_->info, nlohmann::json::object()), {-1, true, c.profile});
    } catch (const Error& e) {
      const char* allowed = std::getenv("CLOTHBENCH_ALLOW_NO_DEVICE");
      if (e.code() == ExitCode::NoDevice && allowed != nullptr && std::string(allowed) == "1") GTEST_SKIP() << e.what();
      FAIL() << e.what();
    }
  }
  void TearDown() override {
    if (solver_) {
      EXPECT_EQ(solver_->validation_messages(), 0);
    }
  }
  void run(int frames) {
    for (int f = 0; f < frames; ++f) ASSERT_EQ(solver_->step(frame_input(scene_, f)), StepStatus::Ok) << "frame " << f;
  }

  Scene scene_;
  const SolverEntry* entry_ = nullptr;
  std::unique_ptr<ClothSolver> solver_;
};

TEST_P(Conformance, DoesWhatABackendMust) {
  const SolverInfo& info = solver_->info();
  EXPECT_EQ(info.name, entry_->info.name);
  EXPECT_TRUE((info.supports & info.ignores).empty()) << "a feature is either served or ignored";
  if (!unsupported(info, scene_.needs).empty()) return;  // an `unsupported` row

  solver_->load(scene_);
  const Plan plan = solver_->plan();
  EXPECT_EQ(check_stages(scene_, info, plan), "");
  if ((scene_.needs & kColliderFeatures).empty()) {
    for (const BufferPlan& b : plan.buffers) EXPECT_EQ(b.name.find("olli"), std::string::npos) << b.name << ": the scene has nothing to collide with";
  }

  ClothState start, once, again;
  solver_->read_state(start);
  const std::vector<double> rest = initial_positions(scene_);
  ASSERT_EQ(start.position.size(), rest.size());
  ASSERT_EQ(start.velocity.size(), rest.size());
  for (std::size_t k = 0; k < rest.size(); ++k)
    EXPECT_NEAR(start.position[k], rest[k], 1e-6 * scene_.cloth.width_m) << "the cloth starts where the scene puts it";

  if (!GetParam().profile.empty()) {
    const DeviceInfo device = solver_->device();
    EXPECT_NE(device.name.find(GetParam().profile), std::string::npos) << "no result passes for the device's own";
    EXPECT_EQ(nlohmann::json::parse(device.properties_json).at("device_profile"), GetParam().profile);
  }

  run(6);
  solver_->read_state(once);
  for (std::size_t k = 0; k < once.position.size(); ++k) ASSERT_TRUE(std::isfinite(once.position[k]) && std::isfinite(once.velocity[k]));
  for (std::uint32_t v : scene_.pins.vertices)
    for (std::size_t k = 0; k < 3 && !info.ignores.has(Feature::Pins); ++k) {
      EXPECT_NEAR(once.position[3 * v + k], rest[3 * v + k], 1e-6 * scene_.cloth.width_m);
    }

  const FrameCost cost = solver_->last_cost();
  EXPECT_EQ(cost.stage_device_s.size(), plan.stages.size());
  EXPECT_EQ(cost.stage_read_B.size(), plan.stages.size());
  EXPECT_EQ(cost.stage_write_B.size(), plan.stages.size());
  EXPECT_EQ(std::isfinite(cost.device_s), info.on_gpu) << "device time where there is a device, and only there";

  solver_->reset();
  solver_->read_state(again);
  EXPECT_EQ(again.position, start.position) << "reset restores the start bit for bit";
  EXPECT_EQ(again.velocity, start.velocity);
}

INSTANTIATE_TEST_SUITE_P(Every, Conformance, ::testing::ValuesIn(cases()), case_name);

}  // namespace
}  // namespace clothbench

// One body x every registered solver x every scene: what any backend must do, whatever its method.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <filesystem>
#include <map>
#include <nlohmann/json.hpp>
#include <numeric>
#include <ostream>

#include "clothbench/error.hpp"
#include "clothbench/solver.hpp"
#include "runner/frame_loop.hpp"
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
  const auto shift = std::accumulate(scene.begin(), scene.end(), std::size_t{0},
                                     [](std::size_t n, char c) { return n + static_cast<unsigned char>(c); });
  return (sides + grid + shift) % 3 == 0;
}

const std::vector<SolverEntry>& under_test() {
#ifdef CLOTHBENCH_PLUGIN_UNDER_TEST
  static const std::vector<SolverEntry> plugin = {find_solver("plugin:" CLOTHBENCH_PLUGIN_UNDER_TEST)};
  return plugin;
#else
  return solvers();
#endif
}

std::vector<Case> cases() {
  const char *const sides[] = {"single", "double-duplicated", "double"},
                    *const grids[] = {"[2,2]", "[9,7]", "[17,33]"};  // not multiples of any workgroup
  std::vector<Case> all;
  for (const SolverEntry& e : under_test())
    for (const auto& file : fs::recursive_directory_iterator(CLOTHBENCH_SOURCE_DIR "/scenarios")) {
      fs::path relative = fs::relative(file.path(), CLOTHBENCH_SOURCE_DIR "/scenarios");
      const std::string folder = relative.begin()->string();
      if (folder == "stability") continue;  // they name vertices of their own grids, and are there to fail
      if (file.path().extension() != ".json" || folder == "schema" || folder == "studies" || folder == "assets")
        continue;
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

Scene scene_of(const Case& c) {
  std::vector<std::string> overrides = {"cloth.sides=" + c.sides, "cloth.grid=" + c.grid};
  // Four vertices have none near a hand.
  if (c.grid == "[2,2]" && c.scene.find("stretch") != std::string::npos)
    for (const char* hand : {"0", "1"}) overrides.push_back(std::string("grips.") + hand + ".radius_m=0.6");
  if (c.grid == "[2,2]" && c.scene.find("catenary") != std::string::npos)
    overrides.back() = "cloth.grid=[3,2]";  // 2 columns cannot bend
  // A strip that starts over a cylinder needs runs shorter than it is thick.
  if (c.grid != "[17,33]" &&
      (c.scene.find("capstan") != std::string::npos || c.scene.find("atwood") != std::string::npos ||
       c.scene.find("self-fold") != std::string::npos))
    overrides.back() = c.grid == "[2,2]" ? "cloth.grid=[17,2]" : "cloth.grid=[17,7]";
  if (load_scene(c.scene).cloth.mesh) overrides.pop_back();  // a mesh has one size
  return load_scene(c.scene, overrides);
}

std::vector<std::string> names_of(FeatureSet set) {
  std::vector<std::string> names;
  set.for_each([&](Feature f) { names.emplace_back(name_of(f)); });
  return names;
}

/// Its constraints are exact: a sheet with inextensible diagonals too has more of them than ways to move.
bool over_determined(const std::string& solver, const Scene& s) {
  return solver == "reference" && !s.material.membrane_stiffness_N_per_m &&
         (s.needs.has(Feature::Shear) || s.cloth.mesh);
}

/// Why a case is no test of the solver; empty if it is.
std::string reason_to_skip(const SolverInfo& info, const Scene& s) {
  if (over_determined(info.name, s)) return "diverges: over-determined";
  std::string text;
  for (const std::string& name : names_of(unsupported(info, s.needs))) text += (text.empty() ? "has no " : ", ") + name;
  return text;
}

class Conformance : public ::testing::TestWithParam<Case> {
 protected:
  void SetUp() override {
    const Case& c = GetParam();
    scene_ = scene_of(c);
    entry_ = &find_solver(c.solver);
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
  if (const std::string reason = reason_to_skip(info, scene_); !reason.empty())
    GTEST_SKIP() << info.name << " " << reason;

  solver_->load(scene_);
  const Plan plan = solver_->plan();
  EXPECT_EQ(check_stages(scene_, info, plan), "");
  if ((scene_.needs & kColliderFeatures).empty()) {
    for (const BufferPlan& b : plan.buffers)
      EXPECT_EQ(b.name.find("olli"), std::string::npos) << b.name << ": the scene has nothing to collide with";
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
  for (std::size_t k = 0; k < once.position.size(); ++k)
    ASSERT_TRUE(std::isfinite(once.position[k]) && std::isfinite(once.velocity[k]));
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

/// What a solver may lack, and so which cases are skipped. Whoever makes a solver do less must say so here.
struct Lacks {
  std::string solver;
  FeatureSet features;                                 ///< neither served nor ignored
  std::vector<std::pair<Feature, Feature>> only_with;  ///< SolverInfo::only_with
  double most_skipped;                                 ///< share of its cases
};

const FeatureSet kNoBodies = kColliderFeatures | FeatureSet{Feature::Friction, Feature::DoubleSided};
const std::vector<Lacks> kLacks = {
    {"ballistic", {}, {}, 0},
    {"xpbd", {Feature::DuplicatedLayer, Feature::Render}, {}, 0.36},
    {"paper",
     {Feature::Plane, Feature::DoubleSided, Feature::SelfCollision, Feature::Render, Feature::Regions,
      Feature::ClothMesh},
     {{Feature::StaticMesh, Feature::DuplicatedLayer}, {Feature::MovingMesh, Feature::DuplicatedLayer}},
     0.38},
    {"bullet-soft",
     {Feature::DuplicatedLayer, Feature::SelfCollision, Feature::Render, Feature::Regions, Feature::ClothMesh},
     {},
     0.4},
    {"bullet-deformable",
     {Feature::DuplicatedLayer, Feature::SelfCollision, Feature::Render, Feature::ClothMesh},
     {},
     0.4},
    {"reference", kNoBodies | FeatureSet{Feature::DuplicatedLayer, Feature::SelfCollision, Feature::Render}, {}, 0.74},
    {"example-xpbd",
     kNoBodies | FeatureSet{Feature::MovingPins, Feature::DuplicatedLayer, Feature::SelfCollision, Feature::Render,
                            Feature::UnevenGrid, Feature::Regions, Feature::Spin, Feature::ClothMesh},
     {},
     0.79},
};

/// Whether the table says that the case is skipped.
bool may_skip(const Lacks& lacks, const Scene& s) {
  bool alone = false;
  for (const auto& [feature, beside] : lacks.only_with) alone = alone || (s.needs.has(feature) && !s.needs.has(beside));
  return alone || !(s.needs & lacks.features).empty() || over_determined(lacks.solver, s);
}

TEST(ConformanceSkips, AreThoseOfDeclaredFeaturesAndNoMore) {
  std::map<std::string, Scene> scenes;  // what a scene needs doesn't depend on the grid
  const std::vector<Case> all = cases();
  for (const SolverEntry& e : under_test()) {
    const auto lacks =
        std::find_if(kLacks.begin(), kLacks.end(), [&](const Lacks& l) { return l.solver == e.info.name; });
    ASSERT_NE(lacks, kLacks.end()) << e.info.name << ": say in this table what it lacks";
    FeatureSet every;
    for (std::size_t k = 0; k < kFeatureCount; ++k) every.add(static_cast<Feature>(k));
    EXPECT_EQ(names_of(every - e.info.supports - e.info.ignores), names_of(lacks->features)) << e.info.name;
    EXPECT_EQ(e.info.only_with, lacks->only_with) << e.info.name;
    int count = 0, skipped = 0, expected = 0;
    for (const Case& c : all) {
      if (c.solver != e.info.name) continue;
      const auto [at, is_new] = scenes.try_emplace(c.scene + " " + c.sides);
      if (is_new) at->second = scene_of(c);
      ++count;
      skipped += !reason_to_skip(e.info, at->second).empty();
      expected += may_skip(*lacks, at->second);
    }
    ASSERT_GT(count, 0) << e.info.name;
    EXPECT_EQ(skipped, expected) << e.info.name;
    EXPECT_LE(skipped, lacks->most_skipped * count) << e.info.name << ": of " << count << " cases";
  }
}

}  // namespace
}  // namespace clothbench

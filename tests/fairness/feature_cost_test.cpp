// Irrelevant features: how they are added to a scene, that they move no vertex, and the study of their cost from the
// command line.
#include "report/feature_cost.hpp"

#include <gtest/gtest.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cmath>
#include <cstdlib>
#include <filesystem>
#include <fstream>

#include "clothbench/error.hpp"
#include "runner/stage_check.hpp"
#include "scenario/irrelevant.hpp"
#include "scenario/load.hpp"

namespace clothbench {
namespace {

constexpr double kNoOp = 1e-6;  // of the longer side, as the relation "irrelevant" of pairs of runs bounds it

namespace fs = std::filesystem;
using nlohmann::json;

json file_of(const std::string& scene) {
  std::ifstream in(std::string(CLOTHBENCH_SOURCE_DIR "/scenarios/") + scene + ".json");
  return json::parse(in);
}

Scene with_all(const std::string& scene, const SolverInfo& info) {
  const Scene plain = load_scene(scene);
  FeatureSet wanted = info.supports;
  for (const auto& [feature, beside] : info.only_with)
    if (!plain.needs.has(beside)) wanted = wanted - FeatureSet{feature};
  return scene_from_json(with_irrelevant(file_of(scene), plain.needs, wanted),
                         CLOTHBENCH_SOURCE_DIR "/scenarios/" + scene + ".json");
}

TEST(Irrelevant, AddsWhatTheSceneLacksFarAway) {
  const SolverInfo& info = find_solver("xpbd").info;
  const Scene plain = load_scene("validation/swing-strip"), all = with_all("validation/swing-strip", info);
  // Shear, moving pins, a start that turns, runs, stiffness and triangles of their own, and layers that meet are the
  // cloth itself.
  EXPECT_EQ(info.supports - all.needs,
            (FeatureSet{Feature::Shear, Feature::MovingPins, Feature::Spin, Feature::UnevenGrid, Feature::Regions,
                        Feature::ClothMesh, Feature::SelfCollision, Feature::StrainLimit}));
  EXPECT_TRUE((plain.needs - all.needs).empty());
  EXPECT_EQ(all.reference_case, "");
  for (const FrameMotion& m : all.motion)
    for (std::size_t k = 0; k < all.colliders.size(); ++k) {
      std::vector<double> x;
      for (const Capsule& c : m.colliders[k].capsules) x.insert(x.end(), c.a_m.begin(), c.a_m.end());
      if (all.colliders[k].mesh) x = posed_positions(*all.colliders[k].mesh, m.colliders[k]);
      for (std::size_t v = 0; v < x.size(); v += 3) ASSERT_GT(std::hypot(x[v], x[v + 1], x[v + 2]), 95);
    }
}

TEST(Irrelevant, LeavesAFullSceneAlone) {
  const json scene = file_of("paper/gravity");
  const FeatureSet needs = load_scene("paper/gravity").needs;
  EXPECT_EQ(with_irrelevant(scene, needs, needs), scene);
  EXPECT_EQ(with_irrelevant(scene, needs, {}), scene);
  const json touched = with_irrelevant(file_of("contact/sphere"), load_scene("contact/sphere").needs,
                                       {Feature::DoubleSided, Feature::Box});
  EXPECT_EQ(touched["cloth"]["sides"], file_of("contact/sphere")["cloth"]["sides"])
      << "a cloth that touches something keeps its sides";
  EXPECT_EQ(touched["colliders"].size(), 2u);
}

struct Case {
  std::string solver, scene;
};

std::vector<Case> cases() {
  std::vector<Case> out;
  for (const SolverEntry& e : solvers()) {
    if (!e.info.ignores.empty()) continue;
    for (const char* scene : {"paper/gravity", "validation/swing-strip", "validation/catenary",
                              "validation/two-hand-pull", "paper/two-hand-stretch-2mps"})
      out.push_back({e.info.name, scene});
    if (e.info.name != "xpbd") continue;
    for (const char* scene : {"validation/free-fall", "validation/pendulum", "validation/heavy-strip",
                              "validation/cantilever-10", "validation/hang", "validation/hang-elastic"})
      out.push_back({e.info.name, scene});
  }
  return out;
}

class NoOp : public ::testing::TestWithParam<Case> {};
INSTANTIATE_TEST_SUITE_P(Every, NoOp, ::testing::ValuesIn(cases()), [](const auto& i) {
  std::string name = i.param.solver + "_" + i.param.scene;
  for (char& c : name)
    if (!std::isalnum(static_cast<unsigned char>(c))) c = '_';
  return name;
});

std::vector<double> run(const SolverEntry& entry, const Scene& scene, int frames) {
  // As in the study: the substeps and the order in time that a solver chooses by itself may depend on the features of
  // the scene.
  const json settings = entry.info.name == "xpbd" ? json{{"substeps", 10}, {"time_order", 1}} : json::object();
  const auto solver = entry.make(complete_settings(entry.info, settings), {});
  solver->load(scene);
  EXPECT_EQ(check_stages(scene, entry.info, solver->plan()), "");
  std::vector<double> out;
  ClothState state;
  for (int f = 0; f < frames; ++f) {
    EXPECT_EQ(solver->step({f, (f + 1) * scene.time.dt(), scene.time.dt(), scene.motion_after(f)}), StepStatus::Ok);
    solver->read_state(state);
    out.insert(out.end(), state.position.begin(), state.position.end());
  }
  return out;
}

/// xpbd must not move, over a second or the whole scene, in scenes that would make a last digit a hundredth of the
/// cloth too (hang, two-hand-stretch): it keeps every bit. The others are measured, and what they do is their property:
/// see README.md.
TEST_P(NoOp, MovesNothing) {
  const SolverEntry& entry = find_solver(GetParam().solver);
  const Scene plain = load_scene(GetParam().scene), all = with_all(GetParam().scene, entry.info);
  EXPECT_TRUE(unsupported(entry.info, all.needs).empty());
  if (all.needs == plain.needs) GTEST_SKIP() << "nothing to switch on";
  const bool ours = entry.info.name == "xpbd";
  const int frames = ours ? std::min(plain.time.frames(), static_cast<int>(plain.time.frame_rate_hz)) : 10;
  try {
    const std::vector<double> a = run(entry, plain, frames), b = run(entry, all, frames);
    ASSERT_EQ(a.size(), b.size());
    double most = 0;
    for (std::size_t k = 0; k < a.size(); ++k)
      if (!(std::abs(a[k] - b[k]) <= most)) most = std::abs(a[k] - b[k]);
    most /= std::max(plain.cloth.width_m, plain.cloth.height_m);
    EXPECT_TRUE(std::isfinite(most));
    RecordProperty("moved", std::to_string(most));
    if (ours) {
      EXPECT_LE(most, kNoOp);
      EXPECT_EQ(most, 0) << "the same bits";
    }
  } catch (const Error& e) {
    const char* allowed = std::getenv("CLOTHBENCH_ALLOW_NO_DEVICE");
    if (e.code() == ExitCode::NoDevice && allowed != nullptr && std::string(allowed) == "1") GTEST_SKIP() << e.what();
    FAIL() << e.what();
  }
}

int command(const std::string& arguments) {
  const int status = std::system((std::string(CLOTHBENCH_COMMAND) + " " + arguments).c_str());
  return WIFEXITED(status) ? WEXITSTATUS(status) : -1;
}

TEST(QuickStudy, PairsRunsAndReportsTheirCost) {
  const fs::path dir = fs::temp_directory_path() / ("clothbench-feature-cost-" + std::to_string(getpid()));
  ASSERT_EQ(command("study feature-cost --quick --solver bullet-soft --out " + (dir / "run").string() + " > /dev/null"),
            0);
  ASSERT_EQ(command("report " + (dir / "run").string() + " -o " + (dir / "report").string() + " > /dev/null"), 0);
  std::ifstream in(dir / "report/feature-cost.json");
  const json rows = json::parse(in);
  ASSERT_EQ(rows.size(), 2u);
  for (const json& row : rows) {
    EXPECT_EQ(row["needed"]["status"], "ok");
    EXPECT_EQ(row["all"]["status"], "ok");
    EXPECT_GT(row["wall_ratio"].get<double>(), 1.2) << row["scene"] << ": contact in vain costs nothing?";
    EXPECT_EQ(row["added"].back(), "double_sided");
  }
  EXPECT_TRUE(rows[0]["no_op"].get<bool>()) << "a free fall feels no bending";
  EXPECT_FALSE(rows[1]["no_op"].get<bool>()) << "links that any rigidity adds are as stiff as all others";
  EXPECT_FALSE(fs::exists(dir / "report/work-precision.md")) << "a comparison of costs has no ranks by error";
  fs::remove_all(dir);
}

}  // namespace
}  // namespace clothbench

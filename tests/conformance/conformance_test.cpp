// One body x every registered solver x every scene: what any backend must do, whatever its method.
#include "runner/conformance.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cstdlib>
#include <filesystem>
#include <map>
#include <nlohmann/json.hpp>
#include <numeric>
#include <ostream>
#include <set>

#include "clothbench/error.hpp"
#include "clothbench/solver.hpp"
#include "clothbench/solver_names.hpp"
#include "scenario/load.hpp"
#include "scenario/study.hpp"

namespace clothbench {
namespace {

namespace fs = std::filesystem;

struct Case : ConformanceCase {
  std::string solver;
};

void PrintTo(const Case& c, std::ostream* out) { *out << c.solver << " on " << c.scene; }

/// A sixth of a scene's combinations of sides, grid and mesh, another sixth for another scene; all in the slow tier.
bool chosen(const std::string& scene, std::size_t combination) {
  if (CLOTHBENCH_ALL_CASES) return true;
  const auto shift = std::accumulate(scene.begin(), scene.end(), std::size_t{0},
                                     [](std::size_t n, char c) { return n + static_cast<unsigned char>(c); });
  return (combination + shift) % 6 == 0;
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
  std::vector<Case> all;
  for (const SolverEntry& e : under_test())
    for (const auto& file : fs::recursive_directory_iterator(CLOTHBENCH_SOURCE_DIR "/scenarios")) {
      fs::path relative = fs::relative(file.path(), CLOTHBENCH_SOURCE_DIR "/scenarios");
      const std::string folder = relative.begin()->string();
      if (folder == "stability") continue;  // they name vertices of their own grids, and are there to fail
      if (file.path().extension() != ".json" || folder == "schema" || folder == "studies" || folder == "assets")
        continue;
      const std::string scene = relative.replace_extension().string();
      // A cylinder of 384 sides takes minutes on a software device, and capstan-hold needs the same features.
      if (!CLOTHBENCH_ALL_CASES && scene == "validation/capstan-slip") continue;
      std::size_t n = 0;  // combinations; a device profile is no new one
      for (const ConformanceCase& c : conformance_cases(scene, e.info.on_gpu)) {
        if (c.whole) continue;  // they take minutes: `clothbench conformance` runs them
        if (c.profile.empty()) ++n;
        if (!c.relation.empty() || chosen(scene, n)) all.push_back({c, e.info.name});
      }
    }
  return all;
}

std::string case_name(const ::testing::TestParamInfo<Case>& info) {
  std::string name = info.param.solver + "_" + info.param.scene + "_" + info.param.sides + "_" + info.param.grid +
                     info.param.relation + (info.param.mesh ? "_mesh" : "") +
                     (info.param.profile.empty() ? "" : "_" + info.param.profile);
  for (char& c : name)
    if (!std::isalnum(static_cast<unsigned char>(c))) c = '_';
  return name;
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

// A study that names a solver of the tree must know it in a build without it.
TEST(SolverNames, OfEverySolverThatIsBuilt) {
  const std::vector<std::string>& names = solver_names_of_tree();
  for (const SolverEntry& e : solvers())
    EXPECT_NE(std::find(names.begin(), names.end(), e.info.name), names.end())
        << e.info.name << ": missing in its line of solvers/CMakeLists.txt";
}

class Conformance : public ::testing::TestWithParam<Case> {};

TEST_P(Conformance, DoesWhatABackendMust) {
  const Case& c = GetParam();
  const Scene scene = conformance_scene(c, c.solver);
  const SolverEntry& entry = find_solver(c.solver);
  if (const std::string reason = conformance_skip(entry.info, scene); !reason.empty()) GTEST_SKIP() << reason;
  try {
    const ConformanceResult result = run_conformance(entry, complete_settings(entry.info, nlohmann::json::object()),
                                                     {.index = -1, .validation = true}, scene, c);
    if (c.relation != "restart") {
      EXPECT_EQ(result.unsupported, "");
    }
    if (result.unsupported.empty()) {
      EXPECT_EQ(result.frames, c.relation.empty() ? 6 : scene.time.frames());
    }
    for (const std::string& fault : result.faults) ADD_FAILURE() << fault;
  } catch (const Error& e) {
    const char* allowed = std::getenv("CLOTHBENCH_ALLOW_NO_DEVICE");
    if (e.code() == ExitCode::NoDevice && allowed != nullptr && std::string(allowed) == "1") GTEST_SKIP() << e.what();
    FAIL() << e.what();
  }
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
     {Feature::Plane, Feature::DoubleSided, Feature::SelfCollision, Feature::Render, Feature::Regions},
     {{Feature::StaticMesh, Feature::DuplicatedLayer}, {Feature::MovingMesh, Feature::DuplicatedLayer}},
     0.38},
    {"bullet-soft", {Feature::DuplicatedLayer, Feature::SelfCollision, Feature::Render, Feature::Regions}, {}, 0.4},
    {"bullet-deformable", {Feature::DuplicatedLayer, Feature::SelfCollision, Feature::Render}, {}, 0.4},
    {"reference", kNoBodies | FeatureSet{Feature::DuplicatedLayer, Feature::SelfCollision, Feature::Render}, {}, 0.74},
    {"example-xpbd",
     kNoBodies | FeatureSet{Feature::MovingPins, Feature::DuplicatedLayer, Feature::SelfCollision, Feature::Render,
                            Feature::UnevenGrid, Feature::Regions, Feature::Spin, Feature::ClothMesh},
     {},
     0.82},
};

/// Whether the table says that the case is skipped.
bool may_skip(const Lacks& lacks, const Scene& s) {
  bool alone = false;
  for (const auto& [feature, beside] : lacks.only_with) alone = alone || (s.needs.has(feature) && !s.needs.has(beside));
  const std::set<std::string> of_grids_alone = {"paper", "bullet-soft", "bullet-deformable"};
  const bool bends = s.cloth.mesh && s.needs.has(Feature::Bend) && of_grids_alone.contains(lacks.solver);
  return alone || bends || !(s.needs & lacks.features).empty() || over_determined(lacks.solver, s);
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
      if (is_new) at->second = conformance_scene(c, c.solver);
      ++count;
      skipped += !conformance_skip(e.info, at->second).empty();
      expected += may_skip(*lacks, at->second);
    }
    ASSERT_GT(count, 0) << e.info.name;
    EXPECT_EQ(skipped, expected) << e.info.name;
    EXPECT_LE(skipped, lacks->most_skipped * count) << e.info.name << ": of " << count << " cases";
  }
}

}  // namespace
}  // namespace clothbench

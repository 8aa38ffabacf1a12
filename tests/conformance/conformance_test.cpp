// Every registered solver on every scene: requirements on any solver, whatever its method.
#include "runner/conformance.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>
#include <map>
#include <nlohmann/json.hpp>
#include <numeric>
#include <ostream>

#include "clothbench/error.hpp"
#include "clothbench/solver.hpp"
#include "scenario/study.hpp"
#include "solvers.hpp"

namespace clothbench {
namespace {

namespace fs = std::filesystem;

struct Case : ConformanceCase {
  std::string solver;
};

void PrintTo(const Case& c, std::ostream* out) { *out << c.solver << " on " << c.scene; }

/// Selects some of a scene's twelve combinations of sides, grid and mesh, varying by scene; the slow tier runs all.
bool chosen(const std::string& scene, std::size_t combination) {
  if (CLOTHBENCH_ALL_CASES) return true;
  const auto shift = std::accumulate(scene.begin(), scene.end(), std::size_t{0},
                                     [](std::size_t n, char c) { return n + static_cast<unsigned char>(c); });
  return (combination + shift) % 12 == 0;
}

/// Combinations that are skipped because they take long; capstan-hold and cantilever-10 test the same features.
bool takes_long(const std::string& solver, const std::string& scene) {
  if (scene == "validation/capstan-slip") return true;  // a cylinder of 384 sides, minutes on a software device
  return solver == "bullet-deformable" && (scene == "validation/cantilever-1" || scene == "validation/cantilever-100");
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
      if (folder == "stability") continue;  // they use vertex indices of their own grids, and are made to fail
      if (file.path().extension() != ".json" || folder == "schema" || folder == "studies" || folder == "assets")
        continue;
      const std::string scene = relative.replace_extension().string();
      if (!CLOTHBENCH_ALL_CASES && takes_long(e.info.name, scene)) continue;
      std::size_t n = 0;  // number of combinations, not counting device profiles
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

// Studies may name a solver that a build lacks, so the names are a list, which must contain every solver.
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
    if (may_lack_device(e)) GTEST_SKIP() << e.what();
    FAIL() << e.what();
  }
}

INSTANTIATE_TEST_SUITE_P(Every, Conformance, ::testing::ValuesIn(cases()), case_name);

/// Maximum fraction of its cases that each solver may skip, so that a solver cannot lose features unnoticed.
const std::map<std::string, double> kMaxSkipped = {
    {"ballistic", 0},           {"xpbd", 0.36},      {"paper", 0.40},       {"bullet-soft", 0.4},
    {"bullet-deformable", 0.4}, {"reference", 0.74}, {"example-xpbd", 0.83}};

TEST(ConformanceSkips, AreNoMoreThanStated) {
  std::map<std::string, Scene> scenes;  // needed features do not depend on the grid
  const std::vector<Case> all = cases();
  for (const SolverEntry& e : under_test()) {
    ASSERT_TRUE(kMaxSkipped.contains(e.info.name)) << e.info.name;
    int count = 0, skipped = 0;
    for (const Case& c : all) {
      if (c.solver != e.info.name) continue;
      const auto [at, is_new] = scenes.try_emplace(c.scene + " " + c.sides);
      if (is_new) at->second = conformance_scene(c, c.solver);
      ++count;
      skipped += !conformance_skip(e.info, at->second).empty();
    }
    ASSERT_GT(count, 0) << e.info.name;
    EXPECT_LE(skipped, kMaxSkipped.at(e.info.name) * count) << e.info.name << ": of " << count << " cases";
  }
}

}  // namespace
}  // namespace clothbench

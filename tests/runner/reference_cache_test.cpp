// A cached reference value is found only if everything on which it depends is equal.
#include <gtest/gtest.h>

#include <fstream>

#include "base/json_text.hpp"
#include "clothbench/solver.hpp"
#include "runner/reference.hpp"
#include "scenario/load.hpp"
#include "with_folder.hpp"

namespace clothbench {
namespace {

namespace fs = std::filesystem;
using nlohmann::json;

Scene pendulum() { return load_scene("validation/pendulum", {"time.duration_s=0.1"}); }
constexpr ReferenceRules kCoarse{48, 8, 1e-8};

fs::path only_file(const fs::path& folder) {
  std::vector<fs::path> all;
  for (const auto& f : fs::directory_iterator(folder)) all.push_back(f.path());
  EXPECT_EQ(all.size(), 1u);
  return all.at(0);
}

TEST(ReferenceKey, NamesAllThatTheValueDependsOn) {
  const Scene s = pendulum();
  const json key = reference_key(s, kCoarse);
  EXPECT_EQ(key, reference_key(s, kCoarse));
  EXPECT_NE(key, reference_key(load_scene("validation/pendulum"), kCoarse));
  EXPECT_NE(key, reference_key(s, {49, 8, 1e-8}));
  EXPECT_NE(key, reference_key(s, {48, 9, 1e-8}));
  EXPECT_NE(key, reference_key(s, {48, 8, 1e-9}));
  EXPECT_EQ(key["solver_version"], find_solver("reference").info.version);
  EXPECT_EQ(key["program_sha256"].get<std::string>().size(), 64u);
  ASSERT_EQ(key["solver_settings"].size(), 2u);
  for (const SettingSpec& setting : find_solver("reference").info.settings)
    if (setting.name != "substeps") {
      EXPECT_TRUE(key["solver_settings"][0].contains(setting.name)) << setting.name;
    }
}

TEST(ReferenceCache, FindsWhatIsOfTheSameKeyAlone) {
  const ScratchFolder folder;
  const Scene s = pendulum();
  int computed = 0;
  const auto value = [&](const ReferenceRules& rules) {
    return references(
               {&s, &s}, fs::path(folder.path()) / "cache", [&](const std::string&) { ++computed; }, rules)
        .at(s.sha256)
        .value;
  };
  const double right = value(kCoarse);
  EXPECT_EQ(value(kCoarse), right);
  EXPECT_EQ(computed, 1);
  const fs::path file = only_file(fs::path(folder.path()) / "cache");
  json stored = parse_json(read_text(file), file.string());
  for (const char* part : {"program_sha256", "solver_version", "settling_substeps", "solver_settings"}) {
    json other = stored;
    other["key"][part] = "another";
    other["values"]["reference_value"] = 42;
    std::ofstream(file) << other;
    EXPECT_EQ(value(kCoarse), right) << part;
  }
  EXPECT_EQ(computed, 5);
  value({48, 8, 1e-9});
  EXPECT_EQ(computed, 6) << "another tolerance";
}

}  // namespace
}  // namespace clothbench

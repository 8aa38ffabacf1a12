// Heading, tiles, facts, warnings and notes of a report.
#include <gtest/gtest.h>

#include "fake_runs.hpp"

namespace clothbench {
namespace {

TEST(Overview, TilesAreOfTheRunsPresent) {
  const std::vector<Tile> tiles = tiles_of(RunTable(study()));
  ASSERT_EQ(tiles.size(), 1u) << "rates only";
  EXPECT_EQ(tiles[0].title, "Frames per second at 128², bullet-soft") << "no solver has a place of its own";
  EXPECT_EQ(tiles[0].value, "1000");
  EXPECT_EQ(tiles[0].others, "xpbd 50.0 (0 trials)") << "without the harness's own cost";
  const Heading h = heading_of(RunTable(study()), {"table3"});
  EXPECT_EQ(h.title, "Cloth solvers on Fake GPU: table3");
  std::vector<RunRecord> runs = study();
  runs.push_back(fake_run("xpbd", 128, "single", 1e-5));
  runs.back().header.setting = "quality=fast";
  EXPECT_EQ(tiles_of(RunTable(runs))[0].value, "1000") << "default settings only";
  EXPECT_TRUE(tiles_of(RunTable({})).empty());
}

TEST(Environment, OneRowPerMachine) {
  std::vector<RunRecord> runs = {fake_run("xpbd", 8, "single", 1), fake_run("xpbd", 9, "single", 1),
                                 fake_run("bullet-soft", 8, "single", 1, false)};
  const Table t = table_of(runs, "Machines of the runs");
  ASSERT_EQ(t.rows.size(), 3u);
  EXPECT_EQ(entry(t, "Fake GPU", "runs") + ", " + entry(t, "CPU", "runs"), "xpbd (2), bullet-soft (1)");
  EXPECT_EQ(entry(t, "CPU", "clocks"), "") << "a column without any value is left out";
}

TEST(Heading, FactsOfAllRunsAndASoftwareDeviceFirst) {
  std::vector<RunRecord> runs = study();
  const auto facts = [&] {
    return joined(heading_of(RunTable(runs), {}).facts, " · ", [](auto& f) { return f.first + " " + f.second; });
  };
  EXPECT_EQ(facts(),
            "GPU Fake GPU · driver 1.2 · CPU Fake CPU · protocol short · commit 0123456789ab · build Release · date "
            "2026-01-01 · trials per run none timed");
  EXPECT_TRUE(warnings_of(RunTable(runs)).empty());
  for (RunRecord& c : runs)
    if (c.header.environment["gpu"] != "CPU") c.header.environment["gpu_is_software"] = true;
  EXPECT_EQ(warnings_of(RunTable(runs)).at(0),
            "Software Vulkan device (Fake GPU): it shows correctness; its times say nothing of a GPU.");
  runs[1].header.environment["gpu"] = "Other GPU";
  runs[1].header.environment["git_dirty"] = true;
  runs[1].header.environment["created"] = "2026-01-02T00:05:00Z";
  EXPECT_NE(facts().find("GPU Fake GPU (software), Other GPU (software)"), std::string::npos) << facts();
  EXPECT_NE(facts().find("(with local changes)"), std::string::npos);
  EXPECT_NE(facts().find("2026-01-01 to 2026-01-02"), std::string::npos);
  for (RunRecord& c : runs) c.header.environment = {{"gpu", nullptr}, {"git_dirty", "?"}};
  EXPECT_EQ(facts(), "trials per run none timed");
}

}  // namespace
}  // namespace clothbench

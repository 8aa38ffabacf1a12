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
  EXPECT_EQ(tiles[0].others, "xpbd 50.0") << "without the harness's own cost";
  const Heading h = heading_of(RunTable(study()), {"table3"});
  EXPECT_EQ(h.title, "Cloth solvers on Fake GPU: table3");
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
            "2026-01-01 · trials none timed");
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
  EXPECT_EQ(facts(), "trials none timed");
}

TEST(Heading, OverheadIsTheSlowestBallisticRun) {
  std::vector<RunRecord> runs = study();
  const auto note = [](const std::vector<RunRecord>& of) { return joined(notes_of(RunTable(of)), "\n"); };
  EXPECT_NE(note(runs).find("0.29 % of a 72 Hz frame (13.89 ms), below the 1 %"), std::string::npos) << note(runs);
  EXPECT_NE(note(runs).find("gravity-128-single"), std::string::npos) << note(runs);
  runs.push_back(fake_run("ballistic", 64, "single", 2e-4, false));
  EXPECT_NE(note(runs).find("1.4 % of a 72 Hz frame (13.89 ms), above the 1 %"), std::string::npos) << note(runs);
  EXPECT_EQ(note({fake_run("xpbd", 8, "single", 1)}), "");
  EXPECT_EQ(note({with_outcome(fake_run("ballistic", 8, "single", 1), "timed_out", 3, "")}).find("overhead"),
            std::string::npos);
}

}  // namespace
}  // namespace clothbench

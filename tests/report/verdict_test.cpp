// All tables, the terminal and JSON agree on whether a run passed.

#include <gtest/gtest.h>

#include <cmath>

#include "clothbench/feature.hpp"
#include "fake_runs.hpp"
#include "report/report.hpp"

namespace clothbench {
namespace {

constexpr const char* kDrawn =
    R"({"drawn":{"kind":"push","speed_m_per_s":3},"colliders":[{"type":"sphere"}],"expect":{"outcome":"ok","depth_max_m":{"at_most":1}}})";

/// A run of a scene with contact and one bound, passed or not.
RunRecord judged(const std::string& solver, bool passed, const std::string& scenario = kDrawn) {
  RunRecord c = fake_run(solver, 8, "single", 1e-3);
  c.header.scenario_json = scenario;
  c.summary["expect.depth_max_m"] = passed ? 1 : 0;
  c.summary["expect.outcome"] = 1;
  c.outcome.expect = passed ? "pass" : "fail: depth_max_m 2 > 1";
  return c;
}

/// A run of a solver that ignores contact, as `ballistic` declares it.
RunRecord without_contact() {
  RunRecord c = judged("ballistic", true);
  nlohmann::json ignored = {name_of(Feature::MovingPins)};
  kColliderFeatures.for_each([&](Feature f) { ignored.push_back(name_of(f)); });
  c.header.environment["solver_features"] = {{"ignores", ignored}};
  return c;
}

TEST(Verdict, CountsWhatTheTableSays) {
  RunRecord unsupported = with_outcome(judged("c", true), "unsupported", -1, "no sphere"),
            crashed = with_outcome(judged("d", true), "crashed", 4, "its process");
  RunRecord unknown = judged("e", true);
  unknown.summary["expect.depth_max_m"] = kMissing;
  unknown.outcome.expect = "not measured";
  const VerdictCounts all =
      count_verdicts({judged("a", true), judged("b", false), unsupported, crashed, unknown, without_contact()});
  EXPECT_EQ(all.text(), "1 of 6 runs passed, 2 failed, 1 ignored contact, 1 unsupported, 1 not measured");
}

TEST(Verdict, ASolverWithoutContactPassesNothingAnywhere) {
  const std::vector<RunRecord> runs = {without_contact()};
  EXPECT_EQ(verdict(runs[0]), "ignored");
  EXPECT_EQ(count_verdicts(runs).text(), "0 of 1 runs passed, 1 ignored contact");
  EXPECT_EQ(in_short_table(RunTable(runs)).rows[1][2], "ignored");
  EXPECT_EQ(table_of(runs, "Random scenes: pass rate").rows[1].back().substr(0, 3), "0/1");
  EXPECT_EQ(runs_json(runs)[0]["verdict"], "ignored");
  EXPECT_EQ(field(parse_csv(runs_csv(RunTable(runs))), 1, "verdict"), "ignored");
}

TEST(Verdict, AFailureCountsBesideABoundThatIsNotMeasuredAndAlsoForWhoIgnoresContact) {
  for (RunRecord c : {judged("a", false), without_contact()}) {
    c.summary["expect.depth_max_m"] = 0;
    c.summary["expect.stretch_max"] = kMissing;
    EXPECT_EQ(verdict(c), "fail") << c.header.solver;
    EXPECT_EQ(verdict(with_outcome(c, "diverged", 17, "")), "diverged at 17");
  }
}

TEST(Verdict, WhereThereIsNoContactItIsNotIgnored) {
  RunRecord c = without_contact();
  c.header.scenario_json = R"({"expect":{"stretch_max":{"at_most":1}}})";
  EXPECT_EQ(verdict(c), "pass");
}

TEST(Verdict, AScenesOutcomeAloneIsNoBound) {
  RunRecord ended = judged("a", true, R"({"colliders":[{"type":"sphere"}],"expect":{"outcome":"ok"}})");
  ended.summary = {{"expect.outcome", 1}};
  EXPECT_EQ(bounds_of(ended), 0u);
  RunRecord crashed = with_outcome(judged("b", true, R"({"cloth":{},"truth":{"case":"free-fall"}})"), "crashed", 4, "");
  crashed.summary.clear();
  EXPECT_EQ(count_verdicts({crashed}).text(), "0 of 1 runs passed, 1 failed") << "a crashed run did not pass";
  RunRecord missing = judged("c", true);
  missing.outcome.status = "missing";
  EXPECT_EQ(count_verdicts({ended, missing, judged("d", true)}).text(), "1 of 1 runs passed");
}

TEST(Verdict, WhatJudgesTheMotionFailsWithoutABound) {
  RunRecord c = judged("a", true);
  c.outcome.expect = "fail: kinematic 0.4 > 0.001";
  EXPECT_EQ(verdict(c), "fail");
  EXPECT_EQ(count_verdicts({c}).passed, 0u);
}

RunRecord run(const std::string& solver, const std::vector<double>& means_s, const Outcome& outcome) {
  RunRecord c;
  c.header.scene = "drop";
  c.header.solver = solver;
  c.header.setting = "default";
  c.outcome = outcome;
  for (const double mean : means_s) {
    TimedTrial t;
    t.frame_wall_s.assign(12, mean);
    c.trials.push_back(t);
  }
  return c;
}

TEST(InShort, HasOutcomeTimesRatioAndRankOfEachRun) {
  Outcome broken, crashed{"crashed", "F3", 7, "its process"};
  broken.expect = "fail: depth_max_m 1 > 0";
  const Table t = in_short_table(RunTable({run("none", {}, crashed), run("slow", {4e-3, 4e-3}, broken),
                                           run("quick", {2e-3, 2e-3, 2e-3}, {}), run("bullet-soft", {4e-3}, {})}));
  ASSERT_EQ(t.rows.size(), 5u);
  using Cells = std::vector<std::string>;
  EXPECT_EQ(t.rows[0], (Cells{"scene", "solver", "outcome", "p50: × bullet-soft", "rank", "trials", "frame p50 [ms]",
                              "p95 / p99 / worst [ms]", "missed 72 / 90 Hz [%]"}));
  EXPECT_EQ(t.rows[1],
            (Cells{"drop", "bullet-soft", "ok", "1.00", "2", "1", "4.00 (4.00–4.00)", "– / – / 4.00", "0.00 / 0.00"}));
  EXPECT_EQ(t.rows[2], (Cells{"drop", "none", "crashed at 7", "–", "–", "–", "–", "–", "–"}));
  EXPECT_EQ(t.rows[3], (Cells{"drop", "quick", "ok", "2.00 (2.00–2.00)", "1", "3", "2.00 (2.00–2.00)",
                              "2.00 / – / 2.00", "0.00 / 0.00"}));
  EXPECT_EQ(t.rows[4][2] + " " + t.rows[4][4], "fail –");
}

TEST(InShort, AClothThatIsTornApartHasNoRankAndFewerFramesAreTold) {
  RunRecord torn = run("torn", {1e-3}, {}), held = run("held", {2e-3}, {}), cut = run("cut", {3e-3}, {}),
            slow = run("slow", {4e-3}, {});
  torn.summary["stretch_max_last_second"] = 3.57;
  held.summary["stretch_max_last_second"] = 0.05;
  cut.trials[0].frame_wall_s.resize(5);
  const Table t = in_short_table(RunTable({torn, held, cut, slow}));
  ASSERT_EQ(t.rows.size(), 5u);
  EXPECT_EQ(t.rows[0][3] + ", " + t.rows[0][4], "stretch [%], rank") << "no baseline is present";
  EXPECT_EQ(t.rows[1][6], "3.00 (first 5 frames)") << "too few frames for an interval";
  EXPECT_EQ(t.rows[2][1] + " " + t.rows[2][3] + " " + t.rows[2][4], "held 5.00 1");
  EXPECT_EQ(t.rows[4][1] + " " + t.rows[4][3] + " " + t.rows[4][4], "torn 357 –");
  slow.header.solver = "held";
  slow.header.setting = "substeps=9";
  EXPECT_FALSE(contains(in_short_table(RunTable({torn, held, cut, slow})).rows[0], "rank"))
      << "settings of one solver compete with no other";
}

// Heading, tiles, facts, warnings and notes of a report.

TEST(Overview, TilesAreOfTheRunsPresent) {
  const std::vector<Tile> tiles = tiles_of(RunTable(study()));
  ASSERT_EQ(tiles.size(), 1u) << "rates only";
  EXPECT_EQ(tiles[0].title + ", " + tiles[0].entries[0].label, "Frames per second at 128², bullet-soft");
  EXPECT_EQ(tiles[0].entries[0].value, "1000");
  EXPECT_EQ(tiles[0].others(), "xpbd 50.0 (too few frames for an interval, 0 trials, free fall off by 1.2e-06)")
      << "without the harness's cost";
  EXPECT_EQ(heading_of(RunTable(study()), {"table3"}).title, "Cloth solvers on Fake GPU: table3");
  EXPECT_EQ(heading_of(RunTable(study()), {"a", "b", "c", "d"}).title,
            "Cloth solvers on Fake GPU: 4 studies: a, b, c …");
  std::vector<RunRecord> runs = study();
  runs.push_back(fake_run("xpbd", 128, "single", 1e-5));
  runs.back().header.setting = "quality=fast";
  EXPECT_EQ(tiles_of(RunTable(runs))[0].entries[0].value, "1000") << "default settings only";
  for (const auto& [solver, error] : {std::pair{"software", 1e-6}, {"wrong", 0.74}, {"other", kMissing}})
    for (const char* setting : {"default", "substeps=1"}) {
      runs.push_back(fake_run(solver, 128, "single", 1e-5));
      runs.back().header.environment["gpu_is_software"] = std::string(solver) == "software";
      runs.back().header.settings["substeps"] = runs.back().header.setting = setting;
      runs.back().summary["free_fall_error"] = setting[0] == 's' ? 1e-5 : error;
    }
  const auto tile = [&] { return tiles_of(RunTable(runs))[0]; };
  EXPECT_EQ(tile().left_out, "2 not ranked: software (software device), wrong (free-fall error above 1 %)");
  EXPECT_TRUE(tile().entries[0].about.ends_with(", free fall not checked"));
  EXPECT_TRUE(tiles_of(RunTable({})).empty());
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
            "Software Vulkan device (Fake GPU): its results are valid, but its times tell nothing about a GPU.");
  runs[1].header.environment["gpu"] = "Other GPU";
  runs[1].file = "a/run.h5";
  runs[1].header.environment["git_dirty"] = true;
  runs[1].header.environment["created"] = "2026-01-02T00:05:00Z";
  EXPECT_EQ(facts().find(" · CPU "), std::string::npos) << "the first fact names the devices: " << facts();
  EXPECT_NE(facts().find("(with local changes)"), std::string::npos);
  EXPECT_TRUE(facts().starts_with("measured on Fake CPU, Fake GPU, Other GPU (a) · ")) << facts();
  EXPECT_NE(facts().find("2026-01-01 to 2026-01-02"), std::string::npos);
  for (RunRecord& c : runs) c.header.environment = {{"gpu", nullptr}, {"git_dirty", "?"}};
  EXPECT_EQ(facts(), "trials per run none timed");
  runs[0].withheld["frame_wall_median_s"] = "not timed alone";
  EXPECT_EQ(facts(), "trials per run withheld");
}

// CSV and JSON: every value, exactly.

TEST(Export, RunsCsvReadsBackExactly) {
  std::vector<RunRecord> runs = {fake_run("xpbd", 8, "single", 1.0 / 3),
                                 fake_run("bullet-soft", 8, "double", 1e-300, false)};
  runs.push_back(with_outcome(fake_run("paper", 8, "single", 1), "diverged", 17, "said \"no\", twice\nand stopped"));
  const auto csv = parse_csv(runs_csv(RunTable(runs)));
  ASSERT_EQ(csv.size(), 4u);
  for (const auto& row : csv) EXPECT_EQ(row.size(), csv[0].size());
  for (std::size_t k = 0; k < 2; ++k)
    for (const auto& [name, v] : runs[k].summary) {
      const std::string text = field(csv, k + 1, name);
      if (std::isfinite(v))
        EXPECT_EQ(std::stod(text), v) << name;
      else
        EXPECT_EQ(text, "") << name;
    }
  EXPECT_EQ(field(csv, 1, "grid_x"), "8");
  EXPECT_EQ(field(csv, 1, "gpu"), "Fake GPU");
  EXPECT_EQ(field(csv, 1, "gpu_is_software"), "false");
  EXPECT_EQ(field(csv, 1, "failed_frame"), "");
  EXPECT_EQ(field(csv, 3, "failed_frame"), "17");
  EXPECT_EQ(field(csv, 3, "message"), "said \"no\", twice\nand stopped");
  EXPECT_EQ(field(csv, 3, "fps_median"), "");
}

TEST(Export, InfinityIsSaid) {
  std::vector<RunRecord> runs = {fake_run("xpbd", 8, "single", 1)};
  runs[0].summary["up"] = INFINITY;
  runs[0].summary["down"] = -INFINITY;
  runs[0].summary["missing"] = kMissing;
  const auto csv = parse_csv(runs_csv(RunTable(runs)));
  EXPECT_EQ(field(csv, 1, "up"), "inf");
  EXPECT_EQ(field(csv, 1, "down"), "-inf");
  EXPECT_EQ(field(csv, 1, "missing"), "");
  const nlohmann::json run = nlohmann::json::parse(runs_json(runs).dump()).at(0), summary = run.at("summary");
  EXPECT_EQ(run.at("environment").at("cpu"), "Fake CPU");
  EXPECT_EQ(summary.at("fps_median"), 1);
  EXPECT_EQ(summary.at("up"), "inf");
  EXPECT_EQ(summary.at("down"), "-inf");
  EXPECT_TRUE(summary.at("missing").is_null());
}

}  // namespace
}  // namespace clothbench

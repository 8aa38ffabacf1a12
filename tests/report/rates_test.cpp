// What the tables say, read back from their Markdown.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>

#include "fake_runs.hpp"

namespace clothbench {
namespace {

constexpr const char* kCapped = "Frames per second, capped at 72";
constexpr const char* kUncapped = "Frames per second, uncapped";
constexpr const char* kWall = "Wall time per frame [ms]";
constexpr const char* kOther = "Other clocks, median time per frame [ms]";
constexpr const char* kFall = "Free-fall error over gT²/2 at T = 0.5 s";
constexpr const char* kBytes = "kB per frame, read / written";
constexpr const char* kBandwidth = "Peak bandwidth, read / written [GB/s]";
constexpr const char* kMemory = "Device memory [kB] · dispatches per frame";

/// Every table of frame rates.
std::vector<Table> rate_tables(const std::vector<RunRecord>& runs) {
  const RunTable table(runs);
  std::vector<Table> out;
  for (const View& v : views())
    if (v.section == "rates")
      for (const ViewTable& t : tables_of(v, table)) out.push_back(t);
  return out;
}

std::vector<RunRecord> study() {
  std::vector<RunRecord> runs;
  for (const int n : {128, 8}) {
    runs.push_back(fake_run("xpbd", n, "double", n == 8 ? 2e-4 : 0.0217));
    runs.push_back(fake_run("xpbd", n, "single", n == 8 ? 1e-4 : 0.02));
    runs.push_back(fake_run("bullet-soft", n, "single", 1e-3, false));
    runs.push_back(fake_run("ballistic", n, "single", n == 8 ? 1e-7 : 4e-5, false));
  }
  return runs;
}

TEST(Tables, PublishedColumnsStandBesideOurs) {
  const Table t = table_of(study(), kCapped);
  std::cout << t.markdown();
  EXPECT_EQ(entry(t, "published: PBD single-sided", "single", "128²"), "42");
  EXPECT_EQ(entry(t, "published: PBD double-sided", "double-duplicated", "128²"), "16");
  EXPECT_EQ(entry(t, "published: Unity Cloth", "–", "8²"), "72");
  EXPECT_EQ(entry(t, "xpbd", "single", "8²"), "72.0");
  EXPECT_EQ(entry(t, "xpbd", "single", "128²"), "50.0");
  EXPECT_EQ(entry(t, "xpbd", "double", "128²"), "46.1");
}

TEST(Tables, PublishedValuesAreElevenTimesTheCap) {
  const nlohmann::json p = published_table3();
  int capped = 0, all = 0;
  for (const auto& column : p.at("columns")) {
    ASSERT_EQ(column.at("fps").size(), p.at("resolution").size());
    for (const auto& v : column.at("fps")) {
      ++all;
      if (v == p.at("display_cap_hz")) ++capped;
    }
  }
  EXPECT_EQ(all, 15);
  EXPECT_EQ(capped, 11);
}

TEST(Tables, ResolutionsAscendAndSidesAreInOrder) {
  const auto rows = parse_markdown(table_of(study(), kUncapped).markdown());
  EXPECT_EQ(rows.at(0), (std::vector<std::string>{"solver", "sides", "8²", "128²"}));
  ASSERT_EQ(rows.size(), 5u);
  EXPECT_EQ(rows[3][0] + rows[3][1], "xpbdsingle");
  EXPECT_EQ(rows[4][0] + rows[4][1], "xpbddouble");
}

TEST(Tables, UncappedHasFourDigits) {
  const Table t = table_of(study(), kUncapped);
  EXPECT_EQ(entry(t, "xpbd", "single", "128²"), "50.0");
  EXPECT_EQ(entry(t, "xpbd", "double", "8²"), "5000");
  EXPECT_EQ(entry(t, "xpbd", "single", "8²"), "10.0k");
  EXPECT_EQ(entry(t, "ballistic", "single", "8²"), "10.0M");
}

TEST(Tables, BytesAndMemory) {
  const std::vector<RunRecord> runs = study();
  EXPECT_EQ(entry(table_of(runs, kFall), "xpbd", "single", "8²"), "1.2e-06");
  EXPECT_EQ(entry(table_of(runs, kBytes), "xpbd", "single", "128²"), "256 / 128");
  EXPECT_EQ(entry(table_of(runs, kBandwidth), "xpbd", "single", "128²"), "4.00 / 2.00");
  EXPECT_EQ(entry(table_of(runs, kMemory), "xpbd", "single", "128²"), "8.992 · 14");
}

TEST(Tables, MissingValuesAreDashes) {
  std::vector<RunRecord> runs = study();
  for (const char* word : {kBytes, kBandwidth, kMemory})
    EXPECT_EQ(entry(table_of(runs, word), "bullet-soft", "single", "8²"), "–") << word;
  for (RunRecord& c : runs) c.summary.clear();
  for (const Table& t : rate_tables(runs))
    EXPECT_EQ(t.title, "Table 3: frames per second, capped at 72") << "no values";
}

TEST(Tables, WithoutAGpuThereAreNoTablesOfDashes) {
  std::vector<RunRecord> runs;
  for (const char* solver : {"bullet-soft", "other"}) runs.push_back(fake_run(solver, 8, "single", 1e-3, false));
  for (const char* title : {"GPU time per frame [ms]", kBytes, kBandwidth, kMemory})
    EXPECT_TRUE(tables_titled(runs, title).empty()) << title;
  EXPECT_EQ(entry(table_of(runs, kUncapped), "other", "single", "8²"), "1000");
}

TEST(Tables, RunsThatFailedSayHow) {
  std::vector<RunRecord> runs = study();
  runs.push_back(with_outcome(fake_run("paper", 8, "single", 1), "diverged", 17, "edge | 40 times\nits length"));
  runs.push_back(with_outcome(fake_run("paper", 128, "single", 1), "unsupported", -1, "paper has no Wind"));
  runs.push_back(with_outcome(fake_run("paper", 8, "double", 1), "unsupported", -1, "paper has no Wind"));
  for (const Table& t : rate_tables(runs)) {
    EXPECT_EQ(entry(t, "paper", "single", "8²"), "diverged at 17") << t.title;
    EXPECT_EQ(entry(t, "paper", "single", "128²"), "unsupported") << t.title;
    EXPECT_EQ(entry(t, "paper", "double", "128²"), "–") << "not planned: " << t.title;
  }
  const auto failed = parse_markdown(table_of(runs, "Runs without a result").markdown());
  ASSERT_EQ(failed.size(), 3u);
  EXPECT_EQ(failed[1], (std::vector<std::string>{"paper", "diverged (F1)", "edge \\| 40 times its length",
                                                 "gravity-8-single (frame 17)"}));
  EXPECT_EQ(failed[2][3], "gravity-128-single, gravity-8-double");
  EXPECT_TRUE(tables_titled(study(), "Runs without a result").empty());
}

TEST(Tables, FailedCriteriaAreListed) {
  constexpr const char* kFailed = "Acceptance criteria that failed";
  std::vector<RunRecord> runs = study();
  EXPECT_TRUE(tables_titled(runs, kFailed).empty()) << "nothing expected";
  runs[0].outcome.expect = "fail: crossings_max 2 > 0";
  runs[1].outcome.expect = "pass";
  const Table t = table_of(runs, kFailed);
  ASSERT_EQ(t.rows.size(), 2u);
  EXPECT_EQ(t.rows[1], (std::vector<std::string>{runs[0].header.scene, "xpbd", "fail: crossings_max 2 > 0"}));
}

TEST(Tables, TimesPerFrameHaveTailsAndMissedDeadlines) {
  RunRecord c = fake_run("xpbd", 8, "single", 1e-3);
  c.header.scenario_json = R"({"name":"gravity","cloth":{"grid":[8,8],"sides":"single"},"time":{"frame_rate_hz":100}})";
  TimedTrial one, two;
  for (int k = 1; k <= 50; ++k) {
    one.frame_wall_s.push_back(1e-3 * k);
    two.frame_wall_s.push_back(1e-3 * (50 + k));
  }
  c.trials = {one, two};
  const Table t = table_of({c}, kWall);
  const auto value = [&](const std::string& head) { return entry(t, "gravity-8-single", "xpbd", head); };
  EXPECT_EQ(value("trials") + " " + value("number of frames") + " " + value("frames"), "2 100 all");
  EXPECT_TRUE(value("p50 (95 %)").starts_with("50.0 (")) << value("p50 (95 %)");
  EXPECT_TRUE(value("p50 (95 %)").ends_with(" ~")) << "two trials that differ by a factor: " << value("p50 (95 %)");
  EXPECT_EQ(value("p95") + " " + value("p99") + " " + value("worst"), "95.0 99.0 100");
  EXPECT_EQ(value("missed at 72 Hz [%]"), "87.0") << "14 to 100 ms";
  EXPECT_EQ(value("missed at 90 Hz [%]"), "89.0");
  EXPECT_EQ(value("real-time factor"), "0.200");
  EXPECT_EQ(value("rank"), "") << "too uncertain";
  EXPECT_NE(value("conditions").find("wide interval"), std::string::npos);
  EXPECT_TRUE(tables_titled({c}, "GPU time per frame [ms]").empty()) << "no GPU times";
  const auto csv = parse_csv(trials_csv(RunTable({c})));
  ASSERT_EQ(csv.size(), 3u);
  for (std::size_t k = 0; k < csv[0].size(); ++k) {
    if (csv[0][k] == "wall_p95_s") {
      EXPECT_EQ(csv[1][k], "0.048");
    }
    if (csv[0][k] == "wall_max_s") {
      EXPECT_EQ(csv[2][k], "0.1");
    }
    if (csv[0][k] == "device_p50_s") {
      EXPECT_EQ(csv[1][k], "");
    }
  }
}

/// A run with trials of `frames` frames that vary by a share of the mean, in an order that is no trend.
RunRecord timed(const std::string& solver, double frame_s, double vary, int frames = 72, int trials = 3) {
  RunRecord c = fake_run(solver, 8, "single", frame_s, false);
  for (int t = 0; t < trials; ++t) {
    TimedTrial trial;
    for (int f = 0; f < frames; ++f)
      trial.frame_wall_s.push_back(frame_s * (1 + vary * (((7919 * f + 104729 * t) % 101) - 50) / 50.0));
    c.trials.push_back(trial);
  }
  return c;
}

TEST(Intervals, HoldTheMedianAndShrinkWithTheSpread) {
  const RunTimes wide = times_of(timed("a", 1e-3, 0.3)), narrow = times_of(timed("a", 1e-3, 0.01)),
                 none = times_of(timed("a", 1e-3, 0.1, 5, 1));
  for (const RunTimes* t : {&wide, &narrow}) {
    EXPECT_LE(t->wall.median.low, t->wall.at(0.5));
    EXPECT_GE(t->wall.median.high, t->wall.at(0.5));
    EXPECT_LE(t->rate.low, 1000.0 * 1.01);
    EXPECT_GE(t->rate.high, 1000.0 * 0.99);
  }
  EXPECT_LT(narrow.wall.median.high - narrow.wall.median.low, wide.wall.median.high - wide.wall.median.low);
  EXPECT_TRUE(std::isnan(none.wall.median.low)) << "too few frames";
  // A trial that is twice as slow as the others makes the interval that wide, however many frames each has.
  RunRecord c = timed("a", 1e-3, 0.01);
  for (double& s : c.trials[1].frame_wall_s) s *= 2;
  for (double& s : c.trials[2].frame_wall_s) s *= 2;
  EXPECT_TRUE(times_of(c).uncertain());
}

TEST(Intervals, RanksAreNoFinerThanThem) {
  std::vector<RunRecord> runs = {timed("near-a", 1.000e-3, 0.05), timed("near-b", 1.002e-3, 0.05),
                                 timed("bullet-soft", 4e-3, 0.01), timed("shaky", 5e-4, 0.9)};
  runs[3].trials.resize(1);
  runs[3].trials[0].frame_wall_s.resize(12);
  const Table t = table_of(runs, kWall);
  const auto value = [&](const std::string& solver, const char* head) {
    return entry(t, "gravity-8-single", solver, head);
  };
  EXPECT_EQ(value("near-a", "rank") + value("near-b", "rank"), "11") << "their intervals overlap";
  EXPECT_EQ(value("bullet-soft", "rank"), "3");
  EXPECT_EQ(value("shaky", "rank"), "–");
  EXPECT_EQ(value("near-a", "× bullet-soft"), "0.250") << "relative to a fixed solver, whoever is fastest";
  EXPECT_EQ(value("bullet-soft", "× bullet-soft"), "1.00");
}

TEST(Intervals, ContactScenesHaveARowOverFramesWithContact) {
  RunRecord c = timed("xpbd", 1e-3, 0, 10, 1);
  c.accuracy.metrics = {{"touching_fraction", "1", "", {0, 0, 0, 0, 0, 0, 0, 0, 0.1, 0.2, 0}}};
  c.trials[0].frame_wall_s[7] = c.trials[0].frame_wall_s[8] = 5e-3;
  const Table t = table_of({c}, kWall);
  ASSERT_EQ(t.rows.size(), 3u);
  const auto column = [&](const char* head) {
    return static_cast<std::size_t>(std::find(t.rows[0].begin(), t.rows[0].end(), head) - t.rows[0].begin());
  };
  EXPECT_EQ(t.rows[1][column("frames")] + ", " + t.rows[2][column("frames")], "all, with contact");
  EXPECT_EQ(t.rows[2][column("number of frames")], "2");
  EXPECT_TRUE(t.rows[1][column("p50 (95 %)")].starts_with("1.00")) << "a median over frames without contact";
  EXPECT_EQ(t.rows[2][column("p50 (95 %)")], "5.00");
}

TEST(Tables, TimesNotTakenAloneAreWithheldEverywhereAndTheTableSaysWhy) {
  std::vector<RunRecord> runs = {fake_run("alone", 8, "single", 0.002), fake_run("crowd", 8, "single", 0.002),
                                 fake_run("silent", 8, "single", 0.002)};
  runs[1].summary["jobs"] = 11;
  runs[2].summary["jobs"] = kMissing;
  runs[1].trials.resize(1);
  withhold_times(runs);
  EXPECT_TRUE(runs[1].trials.empty());
  for (const char* title : {kCapped, kUncapped, kBandwidth, kOther}) {
    const Table t = table_of(runs, title);
    if (title != kOther) {
      EXPECT_NE(entry(t, "alone", "single", "8²"), "–") << title;
      EXPECT_EQ(entry(t, "crowd", "single", "8²"), "–") << title;
      EXPECT_NE(entry(t, "silent", "single", "8²"), "–") << title << ": its file does not state it";
    }
    EXPECT_NE(t.note.find("Times of 1 run are withheld (–) because up to 11 jobs ran side by side."), std::string::npos)
        << t.note;
  }
  EXPECT_NE(entry(table_of(runs, kBytes), "crowd", "single", "8²"), "–") << "bytes are no time";
  EXPECT_NE(entry(table_of(runs, kFall), "crowd", "single", "8²"), "–");
  EXPECT_EQ(table_of(runs, kFall).note.find("jobs"), std::string::npos);
  const std::string head = headline(runs, Format::Markdown);
  EXPECT_NE(head.find("up to 11 jobs ran side by side"), std::string::npos) << head;
  EXPECT_NE(head.find("1 of the timed runs does not state whether other jobs ran beside it"), std::string::npos)
      << head;
  EXPECT_NE(in_short_table(runs).note.find("11 jobs"), std::string::npos);
  const nlohmann::json j = runs_json(runs)[1];
  EXPECT_TRUE(j["summary"]["frame_wall_median_s"].is_null());
  EXPECT_EQ(j["withheld"]["frame_wall_median_s"], "not timed alone: up to 11 jobs ran side by side");
  // Where every time is withheld, the table stays with the reason.
  EXPECT_EQ(entry(table_of({runs[1]}, kUncapped), "crowd", "single", "8²"), "–");
}

TEST(Tables, BytesThatAreALowerBoundSaySo) {
  std::vector<RunRecord> runs = {fake_run("a", 8, "single", 0.002), fake_run("b", 8, "single", 0.002)};
  runs[0].header.stages = {{"Lines", {}, 1, "computed"}, {"Contact", {}, 1, "at least"}};
  runs[1].header.stages = {{"Lines", {}, 1, "computed"}};
  EXPECT_EQ(entry(table_of(runs, kBytes), "a", "single", "8²"), "≥ 16.0 / 8.00");
  EXPECT_EQ(entry(table_of(runs, kBytes), "b", "single", "8²"), "16.0 / 8.00");
  EXPECT_EQ(entry(table_of(runs, kBandwidth), "a", "single", "8²"), "≥ 4.00 / 2.00");
  EXPECT_NE(table_of(runs, kBytes).note.find("computed"), std::string::npos);
}

TEST(Tables, EveryLineFitsTheTerminal) {
  std::vector<RunRecord> runs;
  for (const int n : {8, 16, 32, 64, 128})
    for (const char* sides : {"single", "double-duplicated", "double"}) {
      runs.push_back(fake_run("paper", n, sides, 1 / 12345.0));
      runs.back().header.setting = "readback=blocking";
      runs.back().summary["fps_spread"] = 0.43;
      runs.back().summary["read_B_per_frame"] = 118864e3;
      runs.back().summary["write_B_per_frame"] = 42583e3;
    }
  for (const Table& t : rate_tables(runs)) {
    const std::string console = t.console();
    std::istringstream lines(console);
    for (std::string line; std::getline(lines, line);) EXPECT_LE(display_width(line), console_columns()) << line;
    for (const std::string& column : t.rows[0]) EXPECT_NE(console.find(column), std::string::npos) << console;
    if (t.title.starts_with(kBytes)) {
      EXPECT_NE(console.find("solver"), console.rfind("solver")) << "too wide for one piece: " << console;
    }
  }
}

TEST(Tables, LatexKnowsEveryCharacter) {
  const Table t{"Error_max of 50 %", "Set `time.dt_s` & more.", {{"case", "x [mm]"}, {"[a] ≤ 3 × 2", "1.5 – 2"}}};
  EXPECT_EQ(t.latex(),
            "\\begin{table}\n\\caption{Error\\_max of 50 \\%}\n\\begin{tabular}{lr}\n\\toprule\n"
            "case & x {[}mm] \\\\\n\\midrule\n{[}a] $\\le$ 3 $\\times$ 2 & 1.5 -- 2 \\\\\n\\bottomrule\n"
            "\\end{tabular}\n\\par\\footnotesize Set \\texttt{time.dt\\_s} \\& more.\n\\end{table}\n");
  // The tables of a report have no character that LaTeX would have to be taught.
  std::string all;
  for (const Table& t3 : rate_tables(study())) all += t3.latex();
  EXPECT_TRUE(std::all_of(all.begin(), all.end(), [](unsigned char c) { return c < 128; })) << all;
}

TEST(Tables, OtherScenesAreTablesOfTheirOwn) {
  std::vector<RunRecord> runs = study();
  RunRecord other = fake_run("xpbd", 8, "single", 0.5);
  other.header.scene = "hang-8";
  other.header.scenario_json = R"({"name":"hang","cloth":{"grid":[8,8],"sides":"single"}})";
  runs.push_back(other);
  other.header.scene = "odd";
  other.header.scenario_json = R"({"name":"hang","cloth":{"grid":[9,7],"sides":"single"}})";
  runs.push_back(other);
  const std::vector<Table> all = tables_titled(runs, kCapped);
  ASSERT_EQ(all.size(), 2u);
  EXPECT_EQ(all[0].rows.size(), 1u + 3 + 4) << "published and ours";
  const Table& t = all[1];
  EXPECT_EQ(t.title, "Frames per second, capped at 72 (hang)");
  EXPECT_EQ(t.markdown().find("published"), std::string::npos);
  EXPECT_EQ(parse_markdown(t.markdown()).at(0), (std::vector<std::string>{"solver", "sides", "9×7", "8²"}));
  EXPECT_EQ(entry(t, "xpbd", "single", "8²"), "2.0");
}

TEST(Tables, TheSameRunTwiceIsTwoRows) {
  std::vector<RunRecord> runs = {fake_run("xpbd", 8, "single", 0.02), fake_run("xpbd", 8, "single", 0.04)};
  const Table t = table_of(runs, kCapped);
  EXPECT_EQ(entry(t, "xpbd", "single", "8²"), "50.0");
  EXPECT_EQ(entry(t, "xpbd (2)", "single", "8²"), "25.0");
}

TEST(Tables, RunsWithoutASceneDoNotHarm) {
  for (const char* scene :
       {"", "not JSON", "[]", "{}", R"({"cloth":3})", R"({"cloth":{"grid":"x","sides":1},"paper":7})"}) {
    std::vector<RunRecord> runs(1);
    runs[0].header.scenario_json = scene;
    runs[0].header.scene = "s";
    for (const View& v : views())
      for (const Table& t : tables_of(v, RunTable(runs)))
        for (const auto& row : t.rows) EXPECT_EQ(row.size(), t.rows[0].size()) << scene << t.title;
    EXPECT_EQ(parse_csv(runs_csv(RunTable(runs))).size(), 2u) << scene;
  }
  EXPECT_TRUE(RunTable({}).rows().empty());
}

TEST(Overview, Table3HasSpeedAndErrorInOneRow) {
  std::vector<RunRecord> runs = study();
  runs[1].summary["free_fall_error"] = 0.74;  // of xpbd, 128², single
  const Table t = table_of(runs, "Table 3: speed and error");
  EXPECT_EQ(entry(t, "xpbd", "10.0k", "128²"), "50.0");
  EXPECT_EQ(entry(t, "xpbd", "10.0k", "free-fall error"), "7.4e-01 !") << "a rate without meaning is marked";
  EXPECT_EQ(entry(t, "published: PBD single-sided", "72", "128²"), "42");
  const Table all = table_of(runs, "All solvers in one table");
  EXPECT_EQ(entry(all, "xpbd", "50.0", "device"), "Fake GPU");
  EXPECT_EQ(entry(all, "bullet-soft", "1000", "device"), "CPU");
}

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

TEST(Terminal, TablesFitTheColumnsStated) {
  for (const char* columns : {"60", "80", "200"}) {
    setenv("COLUMNS", columns, 1);
    EXPECT_EQ(std::to_string(console_columns()), columns);
    std::size_t widest = 0;
    std::istringstream lines(table_of(study(), "Table 3: speed and error").console());
    for (std::string line; std::getline(lines, line);) widest = std::max(widest, display_width(line));
    EXPECT_LE(widest, console_columns());
  }
  unsetenv("COLUMNS");
  EXPECT_EQ(console_columns(), 80u) << "not a terminal";
}

TEST(Headline, SoftwareComesFirstAndInBold) {
  std::vector<RunRecord> runs = study();
  EXPECT_EQ(headline(runs, Format::Markdown).find("Software"), std::string::npos);
  for (RunRecord& c : runs)
    if (c.header.environment["gpu"] != "CPU") c.header.environment["gpu_is_software"] = true;
  EXPECT_TRUE(
      headline(runs, Format::Markdown)
          .starts_with(
              "**Software Vulkan device (Fake GPU): it shows correctness; its times say nothing of a GPU.**\n"));
  EXPECT_TRUE(headline(runs, Format::Console).starts_with("Software Vulkan device (Fake GPU)"));
}

TEST(Headline, OneLineForEachCombination) {
  std::vector<RunRecord> runs = study();
  runs[1].header.environment["created"] = "2026-01-01T00:05:00Z";
  const std::string one = headline(runs, Format::Markdown);
  EXPECT_NE(one.find("GPU Fake GPU · driver 1.2 · CPU Fake CPU · protocol short · commit 0123456789ab · Release"),
            std::string::npos)
      << one;
  EXPECT_NE(one.find("2026-01-01T00:00:00Z to 2026-01-01T00:05:00Z"), std::string::npos) << one;
  EXPECT_EQ(one.find("no GPU"), std::string::npos) << one;
  runs[1].header.environment["gpu"] = "Other GPU";
  runs[1].header.environment["git_dirty"] = true;
  const std::string two = headline(runs, Format::Markdown);
  EXPECT_NE(two.find("GPU Other GPU"), std::string::npos);
  EXPECT_NE(two.find("(with local changes)"), std::string::npos);
  for (RunRecord& c : runs) c.header.environment = {{"gpu", nullptr}, {"git_dirty", "?"}};
  EXPECT_NE(headline(runs, Format::Markdown).find("no GPU · CPU – · protocol – · commit –"), std::string::npos);
}

TEST(Headline, OverheadIsTheSlowestBallisticRun) {
  std::vector<RunRecord> runs = study();
  const std::string below = overhead_line(runs);
  EXPECT_NE(below.find("0.29 % of a 72 Hz frame (13.89 ms), below the 1 %"), std::string::npos) << below;
  EXPECT_NE(below.find("gravity-128-single"), std::string::npos) << below;
  runs.push_back(fake_run("ballistic", 64, "single", 2e-4, false));
  EXPECT_NE(overhead_line(runs).find("1.4 % of a 72 Hz frame (13.89 ms), **above** the 1 %"), std::string::npos)
      << overhead_line(runs);
  EXPECT_EQ(overhead_line({fake_run("xpbd", 8, "single", 1)}), "");
  EXPECT_EQ(overhead_line({with_outcome(fake_run("ballistic", 8, "single", 1), "timed_out", 3, "")}), "");
}

/// A run of a plugin, which wraps this engine.
RunRecord plugin_run(const std::string& solver, int n, const std::string& engine) {
  RunRecord c = fake_run(solver, n, "single", 1e-3, false);
  c.header.environment["plugin"] = {{"path", "/p.so"}, {"sha256", "00ff"}, {"summary", "a plugin"}};
  if (!engine.empty()) c.header.environment["plugin"]["engine"] = engine;
  c.summary["frame_cpu_median_s"] = 9e-4;
  return c;
}

TEST(Tables, APluginStandsBelowThePublishedRowOfItsEngine) {
  std::vector<RunRecord> runs = study();
  runs.push_back(plugin_run("other", 8, "Unlike"));
  runs.push_back(plugin_run("peer", 8, "NvCloth"));
  runs.push_back(plugin_run("plain", 8, ""));
  const Table t = table_of(runs, kCapped);
  std::vector<std::string> names;
  for (const auto& row : t.rows) names.push_back(row.at(0));
  EXPECT_EQ(names, (std::vector<std::string>{"solver", "published: Unity Cloth", "peer", "published: PBD single-sided",
                                             "published: PBD double-sided", "ballistic", "bullet-soft", "other",
                                             "plain", "xpbd", "xpbd"}));
  EXPECT_NE(t.note.find("peer: the engine behind Unity Cloth"), std::string::npos) << t.note;
  EXPECT_NE(t.note.find("not Unity Cloth"), std::string::npos) << t.note;
  EXPECT_EQ(table_of(study(), kCapped).note.find("not Unity Cloth"), std::string::npos) << "no such plugin";
  EXPECT_EQ(entry(table_of(runs, kOther), "gravity-8-single", "peer", "CPU"), "0.900");
  EXPECT_EQ(entry(table_of(runs, kOther), "gravity-8-single", "xpbd", "CPU"), "–");
  EXPECT_NE(headline(runs, Format::Markdown).find("plain is a plugin"), std::string::npos);
  EXPECT_NE(headline(runs, Format::Markdown).find("Library p.so,"), std::string::npos) << "no path of a machine";
}

}  // namespace
}  // namespace clothbench

// Contents of the tables, read back from their Markdown.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>

#include "fake_runs.hpp"

namespace clothbench {
namespace {

constexpr const char* kTable3 = "Table 3: speed and error";
constexpr const char* kTimes = "Time per frame [ms]";
constexpr const char* kMemory = "Bytes and device memory per frame";
constexpr const char* kBandwidth = "peak bandwidth, read / written [GB/s]";

/// Every table of a report.
std::vector<Table> all_tables(const std::vector<RunRecord>& runs) {
  const RunTable table(runs);
  std::vector<Table> out;
  for (const View& v : views())
    for (const ViewTable& t : tables_of(v, table)) out.push_back(t);
  return out;
}

TEST(Overview, Table3HasSpeedAndErrorInOneRow) {
  std::vector<RunRecord> runs = study();
  runs[1].summary["free_fall_error"] = 0.74;  // of xpbd, 128², single
  runs[1].summary.insert({{"stretch_mean_last_second", 0.2}, {"stretch_max_last_second", 1.5}});
  const Table t = table_of(runs, kTable3);
  std::string heads, rows;
  for (const std::string& head : t.rows[0]) heads += head + "|";
  for (const auto& row : t.rows) rows += row[0] + "|";
  EXPECT_EQ(heads, "solver|8²|16²|32²|64²|128²|free-fall error [g T²/2]|stretch, mean / maximum [%]|device|");
  EXPECT_EQ(rows,
            "solver|bullet-soft|xpbd|xpbd, double|published: Unity Cloth|published: PBD single-sided|"
            "published: PBD double-sided|")
      << "the fastest first, without the harness's own cost";
  EXPECT_EQ(entry(t, "xpbd", "128²"), "50.0");
  EXPECT_EQ(entry(t, "xpbd, double", "128²"), "46.1");
  EXPECT_EQ(entry(t, "xpbd, double", "8²"), "5000") << "four digits";
  EXPECT_EQ(entry(t, "xpbd", "8²"), "10.0k");
  EXPECT_EQ(entry(t, "xpbd", "free-fall error [g T²/2]"), "7.4e-01 !") << "a rate without meaning is marked";
  EXPECT_EQ(entry(t, "xpbd", "stretch, mean / maximum [%]"), "20 / 150 !");
  EXPECT_EQ(entry(t, "published: PBD single-sided", "128²"), "42");
  EXPECT_EQ(entry(t, "published: PBD double-sided", "128²"), "16");
}

TEST(Overview, WorkPerFrameFitsAPlantedLawAndThePublishedRates) {
  std::vector<RunRecord> runs;
  for (const int n : {32, 64, 128})
    for (const char* sides : {"single", "double-duplicated"}) {
      const int layers = std::string(sides) == "single" ? 1 : 2;
      runs.push_back(fake_run("paper", n, sides, n == 32 ? 1 : 1.2e-3 + 0.5e-6 * layers * n * n));
      runs.back().header.settings = {{"iterations", 5}, {"substeps", 2}};
    }
  const Table t = table_of(runs, "Table 3: work per frame");
  const auto cell = [&](const char* solver, const char* column) { return entry(t, solver, column); };
  EXPECT_EQ(cell("paper", "fixed [ms]"), "1.20") << "32² is not among the published rates below the cap";
  EXPECT_EQ(cell("paper", "slope (error) [µs per particle]").substr(0, 4), "0.50");
  EXPECT_EQ(cell("paper", "C2: 128² / 64²"), "2.89");
  // Values for 65, 42, 40 and 16 frames per second from Python's statistics.linear_regression.
  EXPECT_EQ(cell("published: PBD", "fixed [ms]"), "7.48");
  EXPECT_EQ(cell("published: PBD", "slope (error) [µs per particle]"), "1.58 (0.360)");
  EXPECT_EQ(cell("published: PBD", "max residual [%]"), "40 !");
  EXPECT_EQ(cell("published: PBD", "C2: 128² / 64²"), "1.55");
  EXPECT_EQ(cell("published: PBD", "C3: doubled / single at 128²"), "2.62");
  EXPECT_EQ(cell("published: PBD", "C3: doubled / single slope"), "4.45");
  EXPECT_EQ(cell("paper", "C3: doubled / single slope"), "2.00");
  EXPECT_EQ(cell("paper", "iterations at the published slope"), "32 (17–46)");
  runs.pop_back();
  EXPECT_EQ(entry(table_of(runs, "Table 3: work per frame"), "paper", "fixed [ms]"), "incomplete")
      << "a size is missing";
}

TEST(Tables, WithoutValuesThereIsNoTable) {
  std::vector<RunRecord> runs;
  for (const char* solver : {"bullet-soft", "other"}) runs.push_back(fake_run(solver, 8, "single", 1e-3, false));
  EXPECT_TRUE(tables_titled(runs, kMemory).empty());
  EXPECT_EQ(entry(table_of(runs, kTable3), "other", "8²"), "1000");
}

TEST(Tables, RunsThatFailedSayHow) {
  std::vector<RunRecord> runs = study();
  runs.push_back(with_outcome(fake_run("paper", 8, "single", 1), "diverged", 17, "edge | 40 times\nits length"));
  runs.push_back(with_outcome(fake_run("paper", 128, "single", 1), "unsupported", -1, "paper has no Wind"));
  runs.push_back(with_outcome(fake_run("paper", 8, "double", 1), "unsupported", -1, "paper has no Wind"));
  const Table t = table_of(runs, kTable3);
  EXPECT_EQ(entry(t, "paper", "8²"), "diverged at 17");
  EXPECT_EQ(entry(t, "paper", "128²"), "unsupported");
  EXPECT_EQ(entry(t, "paper, double", "128²"), "–") << "not planned";
  const Table failed = table_of(runs, "Runs that failed");
  ASSERT_EQ(failed.rows.size(), 3u);
  EXPECT_EQ(failed.rows[1], (std::vector<std::string>{"paper", "diverged (F1)", "edge | 40 times\nits length",
                                                      "gravity-8-single (frame 17)"}));
  EXPECT_NE(failed.markdown().find("edge \\| 40 times its length"), std::string::npos);
  EXPECT_EQ(failed.rows[2][3], "2 runs: gravity-128-single, gravity-8-double");
  EXPECT_TRUE(tables_titled(study(), "Runs that failed").empty());
}

TEST(Tables, AVerdictThatNoCriterionExplainsIsListed) {
  constexpr const char* kFailed = "Acceptance criteria that are violated";
  std::vector<RunRecord> runs = study();
  EXPECT_TRUE(tables_titled(runs, kFailed).empty()) << "nothing expected";
  runs[0].outcome.expect = "fail: crossings_max 2 > 0";
  runs[1].outcome.expect = "pass";
  const Table t = table_of(runs, kFailed);
  ASSERT_EQ(t.rows.size(), 2u);
  EXPECT_EQ(t.rows[1], (std::vector<std::string>{runs[0].header.scene, "xpbd", "fail: crossings_max 2 > 0", "fail"}));
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
  const Table t = table_of({c}, kTimes);
  const auto value = [&](const std::string& head) { return entry(t, "gravity-8-single", "xpbd", head); };
  EXPECT_EQ(value("trials") + " " + value("frames") + " " + value("clock"), "2 100 wall");
  EXPECT_TRUE(value("frame p50 [ms]").starts_with("50.0 (")) << value("frame p50 [ms]");
  EXPECT_TRUE(value("frame p50 [ms]").ends_with(" ~"))
      << "two trials that differ by a factor: " << value("frame p50 [ms]");
  EXPECT_EQ(value("p95 / p99 / worst [ms]"), "95.0 / 99.0 / 100");
  EXPECT_EQ(value("missed 72 / 90 Hz [%]"), "87.0 / 89.0") << "14 to 100 ms, 12 to 100 ms";
  EXPECT_EQ(value("real-time factor"), "0.200");
  EXPECT_EQ(value("rank"), "") << "too uncertain";
  EXPECT_NE(value("conditions").find("wide interval"), std::string::npos);
  EXPECT_EQ(t.rows.size(), 2u) << "no GPU times";
  // Tables of rates show the same tail times, for the largest mesh.
  const Table rates = table_of({c}, "Frame rates");
  for (const char* head : {"p95 / p99 / worst [ms]", "missed 72 / 90 Hz [%]", "real-time factor", "trials"})
    EXPECT_EQ(entry(rates, "xpbd", head), value(head)) << head;
  EXPECT_EQ(entry(rates, "xpbd", "frame p50 [ms]"), value("frame p50 [ms]"));
  const auto csv = parse_csv(trials_csv(RunTable({c})));
  ASSERT_EQ(csv.size(), 3u);
  EXPECT_EQ(field(csv, 1, "wall_p95_s") + ", " + field(csv, 2, "wall_max_s"), "0.048, 0.1");
  EXPECT_EQ(field(csv, 1, "device_p50_s"), "");
  c.trials[0].frame_device_s = one.frame_wall_s;
  EXPECT_EQ(entry(table_of({c}, "Frame rates"), "xpbd", "GPU: p50 / p95 / p99 / worst [ms]"), "25.0 / 48.0 / – / 50.0");
}

/// A run with trials of `frames` frames whose times vary by a fraction of the mean, in an order without trend.
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
    EXPECT_LE(t->wall.rate.low, 1000.0 * 1.01);
    EXPECT_GE(t->wall.rate.high, 1000.0 * 0.99);
  }
  EXPECT_LT(narrow.wall.median.high - narrow.wall.median.low, wide.wall.median.high - wide.wall.median.low);
  EXPECT_TRUE(std::isnan(none.wall.median.low)) << "too few frames";
  // One trial at half the speed makes the interval wide, however many frames each trial has.
  RunRecord c = timed("a", 1e-3, 0.01);
  for (double& s : c.trials[1].frame_wall_s) s *= 2;
  for (double& s : c.trials[2].frame_wall_s) s *= 2;
  EXPECT_TRUE(times_of(c).wall.uncertain());
}

TEST(Intervals, RanksAreNoFinerThanThem) {
  std::vector<RunRecord> runs = {timed("near-a", 1.000e-3, 0.05), timed("near-b", 1.002e-3, 0.05),
                                 timed("bullet-soft", 4e-3, 0.01), timed("shaky", 5e-4, 0.9)};
  runs[3].trials.resize(1);
  runs[3].trials[0].frame_wall_s.resize(12);
  for (RunRecord& c : runs)
    c.header.environment["precision"] = c.header.solver == "bullet-soft" ? "float64" : "float32";
  const Table t = table_of(runs, kTimes);
  EXPECT_EQ(entry(table_of(runs, kTable3), "bullet-soft", "precision"), "float64") << "a column where solvers differ";
  const auto value = [&](const std::string& solver, const char* head) {
    return entry(t, "gravity-8-single", solver, head);
  };
  EXPECT_EQ(value("near-a", "rank") + value("near-b", "rank"), "11") << "their intervals overlap";
  EXPECT_EQ(value("bullet-soft", "rank"), "3");
  EXPECT_EQ(value("shaky", "rank"), "–");
  EXPECT_EQ(tiles_of(RunTable(runs)).at(0).entries[0].label, "near-a") << "the fastest one is too uncertain";
  EXPECT_EQ(value("near-a", "p50: × bullet-soft"), "4.00 (3.98–4.02)")
      << "relative to a fixed solver, whoever is fastest";
  EXPECT_EQ(value("bullet-soft", "p50: × bullet-soft"), "1.00 (CPU)");
}

TEST(Intervals, ContactScenesHaveARowOverFramesWithContact) {
  RunRecord c = timed("xpbd", 1e-3, 0, 10, 1);
  c.accuracy.metrics = {{"touching_fraction", "1", "", {0, 0, 0, 0, 0, 0, 0, 0, 0.1, 0.2, 0}}};
  c.trials[0].frame_wall_s[7] = c.trials[0].frame_wall_s[8] = 5e-3;
  const Table t = table_of({c}, kTimes);
  ASSERT_EQ(t.rows.size(), 3u);
  EXPECT_EQ(field(t.rows, 1, "clock") + "; " + field(t.rows, 2, "clock"), "wall; wall, with contact");
  EXPECT_EQ(field(t.rows, 2, "frames"), "2");
  EXPECT_TRUE(field(t.rows, 1, "frame p50 [ms]").starts_with("1.00")) << "a median over frames without contact";
  EXPECT_EQ(field(t.rows, 2, "frame p50 [ms]"), "5.00");
  c.trials[0].frame_cpu_s.assign(10, 2e-3);
  c.trials[0].frame_rendered_s.assign(10, 3e-3);
  std::string clocks;
  const Table all = table_of({c}, kTimes);
  for (std::size_t row = 0; row < all.rows.size(); ++row) clocks += field(all.rows, row, "clock") + "|";
  EXPECT_EQ(clocks, "clock|wall|wall, with contact|CPU|wall, with rendering|");
}

TEST(Overview, ScenesWithContactLeadAReportThatHasThem) {
  std::vector<RunRecord> runs = study();
  EXPECT_TRUE(tables_titled(runs, "Leading scenes with contact").empty());
  for (const char* scene : {"sphere-drop", "sweep-1", "desk-1", "desk-2", "hand-push"}) {
    runs.push_back(timed("xpbd", 1e-3, 0.01));
    runs.back().header.scene = scene;
    runs.back().header.scenario_json = R"({"colliders":[{"type":"sphere"}],"time":{"frame_rate_hz":100}})";
    runs.back().accuracy.metrics = {{"depth_m", "m", "", std::vector<double>(73, 1e-3)}};
  }
  runs.push_back(runs.back());
  runs.back().header.solver = "soft";
  runs.back().header.environment.update({{"gpu", "llvmpipe"}, {"gpu_is_software", true}});
  runs.push_back(runs[runs.size() - 2]);
  runs.back().header.solver = "rival";
  runs.back().header.plan["contact_margins"] = {{{"collider", "sphere"}, {"margin_m", 0.02}}};
  const Table t = table_of(runs, "Leading scenes with contact");
  ASSERT_EQ(t.rows.size(), 5u);
  EXPECT_EQ(entry(t, "hand-push", "rival", "contact offset [mm]"), "20");
  for (const char* head : {"rank", "frame p50 [ms]", "with contact: p50 / p95 / p99 / worst [ms]"})
    EXPECT_EQ(entry(t, "hand-push", "soft", head), "–") << "a software device: " << head;
  EXPECT_EQ(t.rows[1][0] + ", " + t.rows[2][0], "desk-1, hand-push") << "one of a kind";
  EXPECT_EQ(entry(t, "hand-push", "xpbd", "real-time factor"), "10.0");
  EXPECT_EQ(entry(t, "hand-push", "xpbd", "with contact: p50 / p95 / p99 / worst [ms]").substr(0, 4), "1.00");
  const Table times = table_of(runs, kTimes);
  const auto at =
      std::find_if(times.rows.begin(), times.rows.end(), [](auto& row) { return row[2] == "wall, with contact"; });
  ASSERT_NE(at, times.rows.end());
  EXPECT_TRUE(contains(*at, "10.0")) << "a real-time factor of frames with contact, too";
}

TEST(Tables, TimesNotTakenAloneAreWithheldEverywhereAndTheTableSaysWhy) {
  std::vector<RunRecord> runs = {fake_run("alone", 8, "single", 0.002), fake_run("crowd", 8, "single", 0.002)};
  runs[1].summary["jobs"] = 11;
  runs[1].trials.resize(1);
  runs = withhold_times(runs);
  EXPECT_TRUE(runs[1].trials.empty());
  const std::string why = "Times of 1 run are withheld (–) because up to 11 jobs ran side by side.";
  const Table t = table_of(runs, kMemory);
  EXPECT_NE(entry(t, "gravity-8-single", "alone", kBandwidth), "–");
  EXPECT_EQ(entry(t, "gravity-8-single", "crowd", kBandwidth), "–");
  EXPECT_NE(entry(t, "gravity-8-single", "crowd", "MB per frame, read / written"), "–") << "bytes are no time";
  EXPECT_NE(t.note.find(why), std::string::npos) << t.note;
  EXPECT_EQ(entry(table_of(runs, kTable3), "crowd", "8²"), "–");
  EXPECT_EQ(warnings_of(RunTable(runs)), std::vector<std::string>{why});
  EXPECT_NE(in_short_table(RunTable(runs)).note.find(why), std::string::npos);
  const nlohmann::json j = runs_json(runs)[1];
  EXPECT_TRUE(j["summary"]["frame_wall_median_s"].is_null());
  EXPECT_EQ(RunTable(runs).rows()[1].not_timed(), j["withheld"]["frame_wall_median_s"]);
  EXPECT_EQ(j["withheld"]["frame_wall_median_s"], "not timed alone: up to 11 jobs ran side by side");
  // If every time is withheld, the table stays and states the reason.
  EXPECT_EQ(entry(table_of({runs[1]}, kTable3), "crowd", "8²"), "–");
}

TEST(Tables, EveryLineFitsTheTerminal) {
  std::vector<RunRecord> runs;
  for (const int n : {8, 128}) runs.push_back(fake_run("paper", n, "double-duplicated", 1 / 12345.0));
  EXPECT_EQ(console_columns(), 80u) << "not a terminal";
  for (const char* columns : {"60", "80", "200"}) {
    setenv("COLUMNS", columns, 1);
    EXPECT_EQ(std::to_string(console_columns()), columns);
    for (const Table& t : all_tables(runs)) {
      if (t.in_full) continue;  // not printed
      const std::string console = t.console();
      std::istringstream lines(console);
      for (std::string line; std::getline(lines, line);) EXPECT_LE(display_width(line), console_columns()) << line;
      for (const std::string& column : t.rows[0]) EXPECT_NE(console.find(column), std::string::npos) << console;
    }
  }
  unsetenv("COLUMNS");
}

TEST(Tables, LatexKnowsEveryCharacter) {
  const Table t{"Error_max of 50 %", "Set `time.dt_s` & more.", {{"case", "x [mm]"}, {"[a] ≤ 3 × 2", "1.5 – 2"}}};
  EXPECT_EQ(t.latex(),
            "\\begin{table}\n\\caption{Error\\_max of 50 \\%}\n\\begin{tabular}{lr}\n\\toprule\n"
            "case & x {[}mm] \\\\\n\\midrule\n{[}a] $\\le$ 3 $\\times$ 2 & 1.5 -- 2 \\\\\n\\bottomrule\n"
            "\\end{tabular}\n\\par\\footnotesize Set \\texttt{time.dt\\_s} \\& more.\n\\end{table}\n");
  // The tables use only characters that LaTeX has without further packages.
  std::string all;
  for (const Table& each : all_tables(study())) all += each.latex();
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
  EXPECT_EQ(tables_titled(runs, kTable3).size(), 1u);
  for (const int n : {8, 16}) {
    other.header.scene = fmt::format("hang-heavy-{}", n);
    other.header.scenario_json = fmt::format(R"({{"name":"hang","cloth":{{"grid":[{},{}],"mass":2}}}})", n, n);
    runs.push_back(other);
  }
  other.header.scenario_json = R"({"name":"hang","cloth":{"grid":[9,7],"mass":3}})";
  other.header.scene = "hang";
  other.file = "again/hang.h5";
  runs.push_back(other);
  const std::vector<Table> all = tables_titled(runs, "Frame rates");
  EXPECT_EQ(joined(all, ", ", &Table::title), "Frame rates: hang, Frame rates: hang-heavy, Frame rates: hang (again)")
      << "scenes of one file that differ in more than resolution say in what, or where they ran";
  const Table& t = all.front();
  EXPECT_EQ(t.rows[0][1] + t.rows[0][2], "9×78²");
  EXPECT_EQ(entry(t, "xpbd", "8²"), "2.0");
  EXPECT_EQ(t.markdown().find("published"), std::string::npos);
}

TEST(Tables, TheSameRunTwiceIsTwoRows) {
  std::vector<RunRecord> runs = {fake_run("xpbd", 8, "single", 0.02), fake_run("xpbd", 8, "single", 0.04)};
  const Table t = table_of(runs, kTable3);
  EXPECT_EQ(entry(t, "xpbd", "8²"), "50.0");
  EXPECT_EQ(entry(t, "xpbd (2)", "8²"), "25.0");
}

/// A run of a plugin, which wraps this engine.
RunRecord plugin_run(const std::string& solver, int n, const std::string& engine) {
  RunRecord c = fake_run(solver, n, "single", 1e-3, false);
  c.header.environment["plugin"] = {{"path", "/p.so"}, {"sha256", "00ff"}, {"summary", "a plugin"}};
  if (!engine.empty()) c.header.environment["plugin"]["engine"] = engine;
  return c;
}

TEST(Tables, APublishedRowNamesThePluginOfItsEngine) {
  std::vector<RunRecord> runs = study();
  for (const auto& [solver, engine] : {std::pair{"other", "Unlike"}, {"peer", "NvCloth"}, {"plain", ""}})
    runs.push_back(plugin_run(solver, 8, engine));
  const Table t = table_of(runs, kTable3);
  std::vector<std::string> names;
  for (const auto& row : t.rows) names.push_back(row.at(0));
  EXPECT_EQ(std::vector(names.end() - 3, names.end()),
            (std::vector<std::string>{"published: Unity Cloth", "published: PBD single-sided",
                                      "published: PBD double-sided"}));
  EXPECT_NE(t.note.find("peer: the engine behind Unity Cloth"), std::string::npos) << t.note;
  EXPECT_NE(t.note.find("not Unity Cloth"), std::string::npos) << t.note;
  EXPECT_EQ(table_of(study(), kTable3).note.find("not Unity Cloth"), std::string::npos) << "no such plugin";
  const std::string notes = joined(notes_of(RunTable(runs)), "\n");
  EXPECT_NE(notes.find("plain is a plugin"), std::string::npos);
  EXPECT_NE(notes.find("Library p.so,"), std::string::npos) << "no path of a machine";
}

}  // namespace
}  // namespace clothbench

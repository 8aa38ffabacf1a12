// What the tables say, read back from their Markdown.
#include <gtest/gtest.h>

#include "fake_runs.hpp"
#include "report/plugin_marks.hpp"
#include "report/withheld.hpp"

namespace clothbench {
namespace {

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
  const Table t = table_of(study(), "Table 3");
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
  const auto rows = parse_markdown(table_of(study(), "uncapped").markdown());
  EXPECT_EQ(rows.at(0), (std::vector<std::string>{"solver", "sides", "8²", "128²"}));
  ASSERT_EQ(rows.size(), 5u);
  EXPECT_EQ(rows[3][0] + rows[3][1], "xpbdsingle");
  EXPECT_EQ(rows[4][0] + rows[4][1], "xpbddouble");
}

TEST(Tables, UncappedHasSpreadAndFourDigits) {
  const Table t = table_of(study(), "uncapped");
  EXPECT_EQ(entry(t, "xpbd", "single", "128²"), "50.0 ± 3.1 %");
  EXPECT_EQ(entry(t, "xpbd", "double", "8²"), "5000 ± 3.1 %");
  EXPECT_EQ(entry(t, "xpbd", "single", "8²"), "10.0k ± 3.1 %");
  EXPECT_EQ(entry(t, "ballistic", "single", "8²"), "10.0M ± 3.1 %");
}

TEST(Tables, TimesBytesAndMemory) {
  const std::vector<RunRecord> runs = study();
  EXPECT_EQ(entry(table_of(runs, "Wall time"), "xpbd", "double", "128²"), "21.7");
  EXPECT_EQ(entry(table_of(runs, "GPU time"), "xpbd", "single", "128²"), "18.0");
  EXPECT_EQ(entry(table_of(runs, "ree-fall"), "xpbd", "single", "8²"), "1.2e-06");
  EXPECT_EQ(entry(table_of(runs, "kB a frame"), "xpbd", "single", "128²"), "256 / 128");
  EXPECT_EQ(entry(table_of(runs, "bandwidth"), "xpbd", "single", "128²"), "4.00 / 2.00");
  EXPECT_EQ(entry(table_of(runs, "memory"), "xpbd", "single", "128²"), "8.992 · 14");
}

TEST(Tables, MissingValuesAreDashes) {
  std::vector<RunRecord> runs = study();
  for (const char* word : {"GPU time", "kB a frame", "bandwidth", "memory"})
    EXPECT_EQ(entry(table_of(runs, word), "bullet-soft", "single", "8²"), "–") << word;
  for (RunRecord& c : runs) c.summary.clear();
  for (const Table& t : fps_tables(families(runs).at(0), published_table3())) {
    EXPECT_EQ(entry(t, "xpbd", "single", "8²"), "–") << t.title;
    EXPECT_EQ(t.markdown().find("nan"), std::string::npos) << t.title;
  }
}

TEST(Tables, WithoutAGpuThereAreNoTablesOfDashes) {
  std::vector<RunRecord> runs;
  for (const char* solver : {"bullet-soft", "other"}) runs.push_back(fake_run(solver, 8, "single", 1e-3, false));
  // Two jobs at a time: times are withheld, which leaves their tables; those of a GPU go all the same.
  for (RunRecord& c : runs) c.summary["jobs"] = 2;
  withhold_times(runs);
  for (const char* word : {"GPU time", "kB a frame", "bandwidth", "memory"})
    EXPECT_THROW(table_of(runs, word), std::runtime_error) << word;
  EXPECT_EQ(entry(table_of(runs, "Wall time"), "other", "single", "8²"), "–");
}

TEST(Tables, RunsThatFailedSayHow) {
  std::vector<RunRecord> runs = study();
  runs.push_back(with_outcome(fake_run("paper", 8, "single", 1), "diverged", 17, "edge | 40 times\nits length"));
  runs.push_back(with_outcome(fake_run("paper", 128, "single", 1), "unsupported", -1, "paper has no Wind"));
  runs.push_back(with_outcome(fake_run("paper", 8, "double", 1), "unsupported", -1, "paper has no Wind"));
  for (const Table& t : fps_tables(families(runs).at(0), published_table3())) {
    EXPECT_EQ(entry(t, "paper", "single", "8²"), "diverged at 17") << t.title;
    EXPECT_EQ(entry(t, "paper", "single", "128²"), "unsupported") << t.title;
    EXPECT_EQ(entry(t, "paper", "double", "128²"), "–") << "not planned: " << t.title;
  }
  const auto failed = parse_markdown(failed_table(runs).markdown());
  ASSERT_EQ(failed.size(), 3u);
  EXPECT_EQ(failed[1], (std::vector<std::string>{"paper", "diverged (F2)", "edge \\| 40 times its length",
                                                 "gravity-8-single (frame 17)"}));
  EXPECT_EQ(failed[2][3], "gravity-128-single, gravity-8-double");
  EXPECT_EQ(failed_table(study()).rows.size(), 1u);
}

TEST(Tables, BrokenExpectationsAreListedAndTheOthersCounted) {
  std::vector<RunRecord> runs = study();
  EXPECT_EQ(expect_table(runs).rows.size(), 1u) << "nothing expected";
  runs[0].outcome.expect = "fail: crossings_max 0.2 > 0";
  runs[1].outcome.expect = "pass";
  runs[2].outcome.expect = "not measured";
  for (const auto& [run, passed] : {std::pair{0, 0.0}, {1, 1.0}, {2, kMissing}})
    runs[static_cast<std::size_t>(run)].summary["expect.crossings_max"] = passed;
  const Table t = expect_table(runs);
  ASSERT_EQ(t.rows.size(), 2u);
  EXPECT_EQ(t.rows[1][0], runs[0].header.scene);
  EXPECT_EQ(t.rows[1][2], "fail: crossings_max 0.2 > 0");
  EXPECT_EQ(t.note, "1 of 3 runs passed, 1 failed, 1 not measured, of those whose scene has a bound.");
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
  for (const Table& t : fps_tables(families(runs).at(0), published_table3())) {
    const std::string console = t.console();
    std::istringstream lines(console);
    for (std::string line; std::getline(lines, line);) EXPECT_LE(display_width(line), kConsoleColumns) << line;
    for (const std::string& column : t.rows[0]) EXPECT_NE(console.find(column), std::string::npos) << console;
    if (t.title.find("kB a frame") != std::string::npos) {
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
  for (const Table& t3 : fps_tables(families(study()).at(0), published_table3())) all += t3.latex();
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
  const std::vector<Family> all = families(runs);
  ASSERT_EQ(all.size(), 2u);
  EXPECT_EQ(all[0].runs.size(), runs.size() - 2);
  const Table t = fps_tables(all[1], published_table3()).front();
  EXPECT_NE(t.title.find("hang"), std::string::npos);
  EXPECT_EQ(t.markdown().find("published"), std::string::npos);
  EXPECT_EQ(parse_markdown(t.markdown()).at(0), (std::vector<std::string>{"solver", "sides", "9×7", "8²"}));
  EXPECT_EQ(entry(t, "xpbd", "single", "8²"), "2.0");
}

TEST(Tables, TheSameRunTwiceIsTwoRows) {
  std::vector<RunRecord> runs = {fake_run("xpbd", 8, "single", 0.02), fake_run("xpbd", 8, "single", 0.04)};
  const Table t = table_of(runs, "Table 3");
  EXPECT_EQ(entry(t, "xpbd", "single", "8²"), "50.0");
  EXPECT_EQ(entry(t, "xpbd (2)", "single", "8²"), "25.0");
}

TEST(Tables, RunsWithoutASceneDoNotHarm) {
  for (const char* scene :
       {"", "not JSON", "[]", "{}", R"({"cloth":3})", R"({"cloth":{"grid":"x","sides":1},"paper":7})"}) {
    std::vector<RunRecord> runs(1);
    runs[0].header.scenario_json = scene;
    runs[0].header.scene = "s";
    ASSERT_EQ(families(runs).size(), 1u) << scene;
    for (const Table& t : fps_tables(families(runs)[0], published_table3())) EXPECT_EQ(t.rows.size(), 2u) << scene;
    EXPECT_EQ(parse_csv(runs_csv(runs)).size(), 2u) << scene;
  }
  EXPECT_TRUE(families({}).empty());
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
  const Table t = table_of(runs, "Table 3");
  std::vector<std::string> names;
  for (const auto& row : t.rows) names.push_back(row.at(0));
  EXPECT_EQ(names, (std::vector<std::string>{"solver", "published: Unity Cloth", "peer", "published: PBD single-sided",
                                             "published: PBD double-sided", "ballistic", "bullet-soft", "other",
                                             "plain", "xpbd", "xpbd"}));
  EXPECT_NE(t.note.find("peer: the engine behind Unity Cloth"), std::string::npos) << t.note;
  EXPECT_NE(t.note.find("not Unity Cloth"), std::string::npos) << t.note;
  EXPECT_EQ(table_of(study(), "Table 3").note.find("not Unity Cloth"), std::string::npos) << "no such plugin";
  EXPECT_EQ(entry(table_of(runs, "CPU time"), "peer", "single", "8²"), "0.900");
  EXPECT_EQ(entry(table_of(runs, "CPU time"), "xpbd", "single", "8²"), "–");
  EXPECT_THROW(table_of(study(), "CPU time"), std::runtime_error) << "files without CPU times have no such table";
}

TEST(Tables, PluginsAreMarkedInTablesAndDataAlike) {
  std::vector<RunRecord> runs = study();
  runs.push_back(plugin_run("jolt", 8, ""));
  const PluginMarks marks(runs);
  EXPECT_EQ(marks.text("jolt"), "jolt†");
  EXPECT_EQ(marks.text("jolt iterations=5, xpbd; not jolting nor my-jolt"),
            "jolt† iterations=5, xpbd; not jolting nor my-jolt");
  EXPECT_EQ(marks.text(marks.text("jolt")), "jolt†") << "once";
  const Table t = marks.table({"", "N.", {{"scene", "solver", "jolt"}, {"jolt", "jolt x=1", "pass"}}});
  EXPECT_EQ(t.rows,
            (std::vector<std::vector<std::string>>{{"scene", "solver", "jolt†"}, {"jolt", "jolt† x=1", "pass"}}));
  EXPECT_EQ(t.note, "N. †: a plugin, built outside of clothbench.");
  EXPECT_EQ(marks.table({"", "N.", {{"solver"}, {"xpbd"}}}).note, "N.");
  EXPECT_EQ(
      marks.data({{"series", {{{"label", "jolt a=1"}, {"scene", "jolt"}}}}, {"not_ranked", {{"jolt", "why"}}}}),
      nlohmann::json({{"series", {{{"label", "jolt† a=1"}, {"scene", "jolt"}}}}, {"not_ranked", {{"jolt†", "why"}}}}));
  EXPECT_NE(t.latex().find("jolt$^\\dagger$ x=1"), std::string::npos) << t.latex();
  EXPECT_EQ(t.latex().find("†"), std::string::npos) << "LaTeX does not know it without a package";
  const PluginMarks none(study());
  EXPECT_EQ(none.text("jolt"), "jolt");
  EXPECT_NE(headline(runs, Format::Markdown).find("jolt† is a plugin"), std::string::npos);
  EXPECT_NE(headline(runs, Format::Markdown).find("Library p.so,"), std::string::npos) << "no path of a machine";
}

}  // namespace
}  // namespace clothbench

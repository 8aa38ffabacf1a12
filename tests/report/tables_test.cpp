// What the tables say, read back from their Markdown.
#include <gtest/gtest.h>

#include "fake_cells.hpp"

namespace clothbench {
namespace {

std::vector<CellRecord> study() {
  std::vector<CellRecord> cells;
  for (const int n : {128, 8}) {
    cells.push_back(fake_cell("xpbd", n, "double", n == 8 ? 2e-4 : 0.0217));
    cells.push_back(fake_cell("xpbd", n, "single", n == 8 ? 1e-4 : 0.02));
    cells.push_back(fake_cell("bullet-soft", n, "single", 1e-3, false));
    cells.push_back(fake_cell("ballistic", n, "single", n == 8 ? 1e-7 : 4e-5, false));
  }
  return cells;
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
  const std::vector<CellRecord> cells = study();
  EXPECT_EQ(entry(table_of(cells, "Wall time"), "xpbd", "double", "128²"), "21.7");
  EXPECT_EQ(entry(table_of(cells, "GPU time"), "xpbd", "single", "128²"), "18.0");
  EXPECT_EQ(entry(table_of(cells, "ree-fall"), "xpbd", "single", "8²"), "1.2e-06");
  EXPECT_EQ(entry(table_of(cells, "kB a frame"), "xpbd", "single", "128²"), "256 / 128");
  EXPECT_EQ(entry(table_of(cells, "bandwidth"), "xpbd", "single", "128²"), "4.00 / 2.00");
  EXPECT_EQ(entry(table_of(cells, "memory"), "xpbd", "single", "128²"), "8.992 · 14");
}

TEST(Tables, MissingValuesAreDashes) {
  std::vector<CellRecord> cells = study();
  for (const char* word : {"GPU time", "kB a frame", "bandwidth", "memory"})
    EXPECT_EQ(entry(table_of(cells, word), "bullet-soft", "single", "8²"), "–") << word;
  for (CellRecord& c : cells) c.summary.clear();
  for (const Table& t : fps_tables(families(cells).at(0), published_table3())) {
    EXPECT_EQ(entry(t, "xpbd", "single", "8²"), "–") << t.title;
    EXPECT_EQ(t.markdown().find("nan"), std::string::npos) << t.title;
  }
}

TEST(Tables, CellsThatFailedSayHow) {
  std::vector<CellRecord> cells = study();
  cells.push_back(with_outcome(fake_cell("paper", 8, "single", 1), "diverged", 17, "edge | 40 times\nits length"));
  cells.push_back(with_outcome(fake_cell("paper", 128, "single", 1), "unsupported", -1, "paper has no Wind"));
  cells.push_back(with_outcome(fake_cell("paper", 8, "double", 1), "unsupported", -1, "paper has no Wind"));
  for (const Table& t : fps_tables(families(cells).at(0), published_table3())) {
    EXPECT_EQ(entry(t, "paper", "single", "8²"), "diverged at 17") << t.title;
    EXPECT_EQ(entry(t, "paper", "single", "128²"), "unsupported") << t.title;
    EXPECT_EQ(entry(t, "paper", "double", "128²"), "–") << "not planned: " << t.title;
  }
  const auto failed = parse_markdown(failed_table(cells).markdown());
  ASSERT_EQ(failed.size(), 3u);
  EXPECT_EQ(failed[1], (std::vector<std::string>{"paper", "diverged (F2)", "edge \\| 40 times its length",
                                                 "gravity-8-single (frame 17)"}));
  EXPECT_EQ(failed[2][3], "gravity-128-single, gravity-8-double");
  EXPECT_EQ(failed_table(study()).rows.size(), 1u);
}

TEST(Tables, BrokenExpectationsAreListedAndTheOthersCounted) {
  std::vector<CellRecord> cells = study();
  EXPECT_EQ(expect_table(cells).rows.size(), 1u) << "nothing expected";
  cells[0].outcome.expect = "broken: tunnelled_fraction_max 0.2 > 0";
  cells[1].outcome.expect = "kept";
  cells[2].outcome.expect = "not measured";
  const Table t = expect_table(cells);
  ASSERT_EQ(t.rows.size(), 2u);
  EXPECT_EQ(t.rows[1][0], cells[0].header.scene);
  EXPECT_EQ(t.rows[1][2], "broken: tunnelled_fraction_max 0.2 > 0");
  EXPECT_EQ(t.note, "1 kept, 1 not measured.");
}

TEST(Tables, EveryLineFitsTheTerminal) {
  std::vector<CellRecord> cells;
  for (const int n : {8, 16, 32, 64, 128})
    for (const char* sides : {"single", "double-duplicated", "double"}) {
      cells.push_back(fake_cell("paper", n, sides, 1 / 12345.0));
      cells.back().header.setting = "readback=blocking";
      cells.back().summary["fps_spread"] = 0.43;
      cells.back().summary["read_B_per_frame"] = 118864e3;
      cells.back().summary["write_B_per_frame"] = 42583e3;
    }
  for (const Table& t : fps_tables(families(cells).at(0), published_table3())) {
    const std::string console = t.console();
    std::istringstream lines(console);
    for (std::string line; std::getline(lines, line);) EXPECT_LE(display_width(line), kConsoleColumns) << line;
    for (const std::string& column : t.rows[0]) EXPECT_NE(console.find(column), std::string::npos) << console;
    if (t.title.find("kB a frame") != std::string::npos) {
      EXPECT_NE(console.find("solver"), console.rfind("solver")) << "too wide for one piece: " << console;
    }
  }
}

TEST(Tables, OtherScenesAreTablesOfTheirOwn) {
  std::vector<CellRecord> cells = study();
  CellRecord other = fake_cell("xpbd", 8, "single", 0.5);
  other.header.scene = "hang-8";
  other.header.scenario_json = R"({"name":"hang","cloth":{"grid":[8,8],"sides":"single"}})";
  cells.push_back(other);
  other.header.scene = "odd";
  other.header.scenario_json = R"({"name":"hang","cloth":{"grid":[9,7],"sides":"single"}})";
  cells.push_back(other);
  const std::vector<Family> all = families(cells);
  ASSERT_EQ(all.size(), 2u);
  EXPECT_EQ(all[0].cells.size(), cells.size() - 2);
  const Table t = fps_tables(all[1], published_table3()).front();
  EXPECT_NE(t.title.find("hang"), std::string::npos);
  EXPECT_EQ(t.markdown().find("published"), std::string::npos);
  EXPECT_EQ(parse_markdown(t.markdown()).at(0), (std::vector<std::string>{"solver", "sides", "9×7", "8²"}));
  EXPECT_EQ(entry(t, "xpbd", "single", "8²"), "2.0");
}

TEST(Tables, TheSameCellTwiceIsTwoRows) {
  std::vector<CellRecord> cells = {fake_cell("xpbd", 8, "single", 0.02), fake_cell("xpbd", 8, "single", 0.04)};
  const Table t = table_of(cells, "Table 3");
  EXPECT_EQ(entry(t, "xpbd", "single", "8²"), "50.0");
  EXPECT_EQ(entry(t, "xpbd (2)", "single", "8²"), "25.0");
}

TEST(Tables, CellsWithoutASceneDoNotHarm) {
  for (const char* scene :
       {"", "not JSON", "[]", "{}", R"({"cloth":3})", R"({"cloth":{"grid":"x","sides":1},"paper":7})"}) {
    std::vector<CellRecord> cells(1);
    cells[0].header.scenario_json = scene;
    cells[0].header.scene = "s";
    ASSERT_EQ(families(cells).size(), 1u) << scene;
    for (const Table& t : fps_tables(families(cells)[0], published_table3())) EXPECT_EQ(t.rows.size(), 2u) << scene;
    EXPECT_EQ(parse_csv(cells_csv(cells)).size(), 2u) << scene;
  }
  EXPECT_TRUE(families({}).empty());
}

TEST(Headline, SoftwareComesFirstAndInBold) {
  std::vector<CellRecord> cells = study();
  EXPECT_EQ(headline(cells, Format::Markdown).find("Software"), std::string::npos);
  for (CellRecord& c : cells)
    if (c.header.environment["gpu"] != "CPU") c.header.environment["gpu_is_software"] = true;
  EXPECT_TRUE(headline(cells, Format::Markdown)
                  .starts_with("**Software Vulkan device (Fake GPU): for correctness, not for speed claims.**\n"));
  EXPECT_TRUE(headline(cells, Format::Console).starts_with("Software Vulkan device (Fake GPU)"));
}

TEST(Headline, OneLineForEachCombination) {
  std::vector<CellRecord> cells = study();
  cells[1].header.environment["created"] = "2026-01-01T00:05:00Z";
  const std::string one = headline(cells, Format::Markdown);
  EXPECT_NE(one.find("GPU Fake GPU · driver 1.2 · CPU Fake CPU · protocol short · commit 0123456789ab · Release"),
            std::string::npos)
      << one;
  EXPECT_NE(one.find("2026-01-01T00:00:00Z to 2026-01-01T00:05:00Z"), std::string::npos) << one;
  EXPECT_EQ(one.find("no GPU"), std::string::npos) << one;
  cells[1].header.environment["gpu"] = "Other GPU";
  cells[1].header.environment["git_dirty"] = true;
  const std::string two = headline(cells, Format::Markdown);
  EXPECT_NE(two.find("GPU Other GPU"), std::string::npos);
  EXPECT_NE(two.find("(with local changes)"), std::string::npos);
  for (CellRecord& c : cells) c.header.environment = {{"gpu", nullptr}, {"git_dirty", "?"}};
  EXPECT_NE(headline(cells, Format::Markdown).find("no GPU · CPU – · protocol – · commit –"), std::string::npos);
}

TEST(Headline, OverheadIsTheSlowestBallisticCell) {
  std::vector<CellRecord> cells = study();
  const std::string below = overhead_line(cells);
  EXPECT_NE(below.find("0.29 % of a 72 Hz frame (13.89 ms), below the 1 %"), std::string::npos) << below;
  EXPECT_NE(below.find("gravity-128-single"), std::string::npos) << below;
  cells.push_back(fake_cell("ballistic", 64, "single", 2e-4, false));
  EXPECT_NE(overhead_line(cells).find("1.4 % of a 72 Hz frame (13.89 ms), **above** the 1 %"), std::string::npos)
      << overhead_line(cells);
  EXPECT_EQ(overhead_line({fake_cell("xpbd", 8, "single", 1)}), "");
  EXPECT_EQ(overhead_line({with_outcome(fake_cell("ballistic", 8, "single", 1), "timed_out", 3, "")}), "");
}

}  // namespace
}  // namespace clothbench

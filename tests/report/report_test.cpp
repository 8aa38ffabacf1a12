#include "report/report.hpp"

#include <gtest/gtest.h>
#include <unistd.h>

#include <filesystem>
#include <fstream>

#include "clothbench/error.hpp"
#include "results/store.hpp"

namespace clothbench {
namespace {

namespace fs = std::filesystem;

CellRecord cell(const std::string& solver, int n, const std::string& sides, double fps, const std::string& status = "ok") {
  CellRecord c;
  c.header.scene = "gravity-" + std::to_string(n) + "-" + sides;
  c.header.solver = solver;
  c.header.setting = "default";
  c.header.settings = nlohmann::json::object();
  c.header.plan = nlohmann::json::object();
  c.header.scenario_json = R"({"cloth":{"grid":[)" + std::to_string(n) + "," + std::to_string(n) + R"(],"sides":")" + sides + "\"}}";
  c.header.environment = {{"gpu", "Some GPU"}, {"driver", "1"}, {"gpu_is_software", false}, {"protocol", "short"}};
  c.outcome.status = status;
  c.outcome.failed_frame = status == "not_finite" ? 17 : -1;
  c.summary = {{"fps_median", fps}, {"fps_spread", 0.02}, {"fps_at_72", std::min(72.0, fps)}, {"frame_wall_median_s", 1 / fps}, {"read_B_per_frame", kMissing}};
  return c;
}

nlohmann::json published() {
  std::ifstream in(CLOTHBENCH_SOURCE_DIR "/results/paper-table3.json");
  return nlohmann::json::parse(in);
}

std::string entry(const Table& t, const std::string& solver, const std::string& sides, std::size_t column) {
  for (const auto& row : t.rows)
    if (row[0] == solver && row[1] == sides) return row.at(column);
  return "no such row";
}

TEST(Report, Table3HasThePublishedColumnsAndOurs) {
  const auto tables = fps_tables({cell("xpbd", 8, "single", 500), cell("xpbd", 128, "single", 30.25), cell("paper", 128, "double-duplicated", 20, "not_finite"),
                                  cell("bullet-soft", 8, "double-duplicated", kMissing, "unsupported")}, published());
  const Table& capped = tables.at(0);
  ASSERT_EQ(capped.rows[0].size(), 4u) << "solver, sides, 8, 128";
  EXPECT_EQ(entry(capped, "published: PBD single-sided", "single", 3), "42.0");
  EXPECT_EQ(entry(capped, "published: PBD double-sided", "double-duplicated", 3), "16.0");
  EXPECT_EQ(entry(capped, "published: Unity Cloth", "–", 2), "72.0");
  EXPECT_EQ(entry(capped, "xpbd", "single", 2), "72.0");
  EXPECT_EQ(entry(capped, "xpbd", "single", 3), "30.2");
  EXPECT_EQ(entry(tables.at(1), "xpbd", "single", 2), "500.0 ± 2 %");
  EXPECT_EQ(entry(capped, "paper", "double-duplicated", 3), "not_finite at 17") << "a failed cell is a row, not a gap";
  EXPECT_EQ(entry(capped, "bullet-soft", "double-duplicated", 2), "unsupported");
  EXPECT_EQ(entry(capped, "bullet-soft", "double-duplicated", 3), "–") << "not run";
}

TEST(Report, MissingValuesAreDashesNeverZeros) {
  const auto tables = fps_tables({cell("bullet-soft", 8, "single", 100)}, published());
  for (const Table& t : tables)
    if (t.title.rfind("Bytes", 0) == 0 || t.title.rfind("Bandwidth", 0) == 0 || t.title.rfind("GPU time", 0) == 0) {
      EXPECT_EQ(entry(t, "bullet-soft", "single", 2), "–") << t.title;
    }
}

TEST(Report, SoftwareDevicesAreSaidFirst) {
  CellRecord c = cell("xpbd", 8, "single", 100);
  c.header.environment["gpu_is_software"] = true;
  EXPECT_EQ(headline({c}).rfind("**Software Vulkan device (Some GPU)", 0), 0u);
  EXPECT_EQ(headline({cell("xpbd", 8, "single", 100)}).find("Software"), std::string::npos);
}

TEST(Report, OverheadIsTheBallisticFrame) {
  const auto with = [](double frame_s) {
    CellRecord c = cell("ballistic", 128, "single", 1 / frame_s);
    std::string notes;
    for (const Table& t : fps_tables({c}, published())) notes += t.note;
    return notes;
  };
  EXPECT_NE(with(20e-6).find("0.144 % of a 72 Hz frame."), std::string::npos) << with(20e-6);
  EXPECT_NE(with(1e-3).find("more than the 1 %"), std::string::npos);
}

TEST(Report, CsvQuotesAndKeepsEveryDigit) {
  EXPECT_EQ(csv_row({"a", "b,c", "d\"e", ""}), "a,\"b,c\",\"d\"\"e\",\n");
  EXPECT_NE(cells_csv({cell("xpbd", 8, "single", 123.45678901234567)}).find("123.45678901234567"), std::string::npos);
}

TEST(Report, WritesEverythingAndDrawsOneLineASeries) {
  const fs::path dir = fs::temp_directory_path() / ("clothbench-report-" + std::to_string(getpid()));
  fs::create_directories(dir / "runs");
  StudyManifest manifest;
  manifest.study = "s";
  for (int n : {8, 16, 32})
    for (const char* sides : {"single", "double"}) {
      CellRecord c = cell("xpbd", n, sides, 1000.0 / n);
      c.summary["bandwidth_read_peak_B_per_s"] = 1e9 * n;
      c.summary["bandwidth_write_peak_B_per_s"] = 5e8 * n;
      CellWriter writer(dir / "runs", c.header);
      manifest.cells.push_back(cell_name(c.header));
      writer.finish(c.outcome, c.summary);
    }
  manifest.cells.push_back("gravity-64-single__xpbd__default");
  write_manifest(dir / "runs", manifest);
  write_report({dir / "runs"}, {dir / "out"});
  for (const char* name : {"report.md", "cells.csv", "cells.json", "table3.csv", "fig4.svg", "fig4.png", "fig5.svg", "fig5.png"}) {
    ASSERT_TRUE(fs::exists(dir / "out" / name)) << name;
    EXPECT_GT(fs::file_size(dir / "out" / name), 20u) << name;
  }
  const auto count = [&](const char* file, const std::string& word) {
    std::ifstream in(dir / "out" / file);
    const std::string text((std::istreambuf_iterator<char>(in)), {});
    int n = 0;
    for (std::size_t at = 0; (at = text.find(word, at)) != std::string::npos; at += word.size()) ++n;
    return n;
  };
  EXPECT_EQ(count("fig4.svg", "id=\"fps xpbd"), 2);
  EXPECT_EQ(count("fig5.svg", "id=\"bandwidth xpbd"), 4);
  EXPECT_EQ(count("cells.csv", ",missing,"), 1) << "a planned cell without a file is a row";
  EXPECT_THROW(write_report({dir / "nowhere"}, {dir / "out"}), Error);
  fs::remove_all(dir);
}

}  // namespace
}  // namespace clothbench

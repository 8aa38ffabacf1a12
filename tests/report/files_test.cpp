// From result files to a folder of tables and figures.
#include <gtest/gtest.h>
#include <unistd.h>

#include <fstream>

#include "clothbench/error.hpp"
#include "fake_cells.hpp"
#include "results/store.hpp"

namespace clothbench {
namespace {

namespace fs = std::filesystem;

class ReportFiles : public ::testing::Test {
 protected:
  void SetUp() override {
    const auto* info = ::testing::UnitTest::GetInstance()->current_test_info();
    dir_ = fs::temp_directory_path() / ("clothbench-report-" + std::to_string(getpid()) + "-" + info->name());
    run_ = dir_ / "run";
    fs::create_directories(run_);
    StudyManifest manifest{"table3", "2026-01-01T00:00:00Z", "clothbench study table3", nlohmann::json::object(), {}};
    for (const int n : {8, 9}) write_cell(fake_cell("xpbd", n, "single", 0.002 * n), manifest);
    write_cell(with_outcome(fake_cell("paper", 8, "single", 1), "diverged", 3, "too long"), manifest);
    manifest.cells.push_back("gravity-9-single__paper__readback=blocking");
    manifest.cells.push_back("gravity-77-single__paper__default");
    write_manifest(run_, manifest);
  }
  void TearDown() override { fs::remove_all(dir_); }

  void write_cell(const CellRecord& c, StudyManifest& manifest) {
    CellWriter writer(run_, c.header);
    writer.finish(c.outcome, c.summary);
    manifest.cells.push_back(cell_name(c.header));
  }

  std::string text(const fs::path& file) const {
    std::ifstream in(file, std::ios::binary);
    EXPECT_TRUE(in.good()) << file;
    return {std::istreambuf_iterator<char>(in), {}};
  }

  fs::path dir_, run_;
};

TEST_F(ReportFiles, PlannedCellsWithoutAFileAreMissing) {
  const std::vector<CellRecord> cells = collect({run_});
  ASSERT_EQ(cells.size(), 5u);
  EXPECT_EQ(cells[3].outcome.status, "missing");
  EXPECT_EQ(cells[3].header.solver, "paper");
  EXPECT_EQ(cells[3].header.setting, "readback=blocking");
  EXPECT_EQ(entry(table_of(cells, "Table 3"), "paper readback=blocking", "single", "9²"), "missing");
  const Table failed = failed_table(cells);
  ASSERT_EQ(failed.rows.size(), 4u);
  EXPECT_EQ(failed.rows[3], (std::vector<std::string>{"paper", "missing", "planned, not run", "gravity-77-single"}));
}

TEST_F(ReportFiles, WritesEveryFile) {
  const fs::path out = dir_ / "it's a report";
  fs::create_directories(out);
  std::ofstream(out / "fig4.svg") << "an older figure";
  write_report({run_}, {out});
  for (const char* file : {"report.md", "table3.md", "table3.csv", "table3.json", "cells.csv", "cells.json",
                           "bandwidth.csv", "memory.csv"})
    EXPECT_GT(fs::file_size(out / file), 0u) << file;
  const std::string md = text(out / "report.md");
  EXPECT_NE(md.find("diverged at 3"), std::string::npos);
  EXPECT_NE(md.find("planned, not run"), std::string::npos);
  EXPECT_EQ(md.find("gravity-77-single"), md.rfind("gravity-77-single")) << "of a scene that nobody ran there is nothing to tabulate";
  EXPECT_EQ(parse_csv(text(out / "memory.csv")).size(), 6u);
  if (md.find("Figures were left out") == std::string::npos) {
    EXPECT_NE(text(out / "fig4.svg").find("<svg"), std::string::npos);
    EXPECT_NE(text(out / "fig5.png").find("PNG"), std::string::npos);
  } else {
    EXPECT_FALSE(fs::exists(out / "fig4.svg")) << "an older figure stands beside new tables";
  }
}

TEST_F(ReportFiles, IsAFunctionOfTheFiles) {
  write_report({run_}, {dir_ / "a"});
  write_report({run_ / ""}, {dir_ / "b"});
  for (const auto& file : fs::directory_iterator(dir_ / "a"))
    EXPECT_EQ(text(file.path()), text(dir_ / "b" / file.path().filename())) << file.path();
}

TEST_F(ReportFiles, SaysWhatCannotBeRead) {
  const auto message = [&](const fs::path& run) {
    try {
      write_report({run}, {dir_ / "out"});
    } catch (const Error& e) {
      return std::string(e.what());
    }
    return std::string("no error");
  };
  EXPECT_NE(message(dir_ / "nothing").find((dir_ / "nothing").string()), std::string::npos);
  EXPECT_NE(message(dir_).find(dir_.string()), std::string::npos) << "a folder without study.json";
  std::ofstream(dir_ / "bad.h5") << "not HDF5";
  EXPECT_NE(message(dir_ / "bad.h5").find("bad.h5"), std::string::npos);
  EXPECT_FALSE(fs::exists(dir_ / "out" / "report.md"));
}

}  // namespace
}  // namespace clothbench

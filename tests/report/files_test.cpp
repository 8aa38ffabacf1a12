// From result files to a folder of tables and figures.
#include "base/files.hpp"

#include <gtest/gtest.h>
#include <unistd.h>

#include <cstdlib>
#include <fstream>
#include <set>

#include "fake_runs.hpp"
#include "refusal.hpp"
#include "report/web/page.hpp"
#include "results/store.hpp"
#include "with_folder.hpp"

namespace clothbench {
namespace {

namespace fs = std::filesystem;

class ReportFiles : public WithFolder {
 protected:
  void SetUp() override {
    run_ = dir_ / "run";
    fs::create_directories(run_);
    StudyManifest manifest{"table3", "2026-01-01T00:00:00Z", "clothbench study table3", nlohmann::json::object(), {}};
    for (const int n : {8, 9}) write_run(fake_run("xpbd", n, "single", 0.002 * n), manifest);
    write_run(with_outcome(fake_run("paper", 8, "single", 1), "diverged", 3, "too long"), manifest);
    manifest.runs.push_back("gravity-9-single__paper__readback=blocking");
    manifest.runs.push_back("gravity-77-single__paper__default");
    write_manifest(run_, manifest);
  }

  void write_run(const RunRecord& c, StudyManifest& manifest) {
    RunWriter writer(run_, c.header);
    writer.finish(c.outcome, c.summary);
    manifest.runs.push_back(run_name(c.header));
  }

  fs::path run_;
};

/// While it exists, PATH contains only programs that the test puts into its folder.
class OnlyPrograms {
 public:
  explicit OnlyPrograms(const fs::path& dir) : dir_(dir), path_("PATH", dir.c_str()) { fs::create_directories(dir); }
  void add(const std::string& name, const std::string& script) const {
    std::ofstream(dir_ / name) << "#!/bin/sh\n" << script << "\n";
    fs::permissions(dir_ / name, fs::perms::owner_all);
  }

 private:
  fs::path dir_;
  Variable path_;
};

bool can_draw() {
  return !page_template().figures.empty() && std::system("node --version >/dev/null 2>&1") == 0 &&
         std::system("rsvg-convert --version >/dev/null 2>&1") == 0;
}

TEST_F(ReportFiles, PlannedRunsWithoutAFileAreMissing) {
  const std::vector<RunRecord> runs = collect({run_});
  ASSERT_EQ(runs.size(), 5u);
  const Table failed = table_of(runs, "Runs that failed");
  ASSERT_EQ(failed.rows.size(), 4u);
  EXPECT_TRUE(
      contains(failed.rows, std::vector<std::string>{"paper", "missing", "planned, not run", "gravity-77-single"}));
  EXPECT_TRUE(contains(failed.rows, std::vector<std::string>{"paper readback=blocking", "missing", "planned, not run",
                                                             "gravity-9-single"}));
}

TEST_F(ReportFiles, WritesEveryFile) {
  const fs::path out = dir_ / "it's a report";
  write_report({run_}, {out});
  for (const char* file : {"report.md", "tables.tex", "runs.csv", "runs.json", "series.csv", "trials.csv"})
    EXPECT_GT(fs::file_size(out / file), 0u) << file;
  EXPECT_EQ(std::count_if(fs::directory_iterator(out), {}, [](auto& e) { return e.is_regular_file(); }),
            fs::exists(out / "index.html") ? 7 : 6)
      << "CSV and JSON are runs, series and trials";
  const std::string md = content_of(out / "report.md");
  EXPECT_NE(md.find("diverged at 3"), std::string::npos);
  EXPECT_NE(md.find("planned, not run"), std::string::npos);
  EXPECT_EQ(md.find("gravity-77-single"), md.rfind("gravity-77-single"))
      << "a scene without runs has nothing to tabulate";
  EXPECT_EQ(parse_csv(content_of(out / "runs.csv")).size(), 6u);
  if (can_draw()) {
    std::set<std::string> names;
    for (const auto& file : fs::directory_iterator(out / "figures")) names.insert(file.path().filename());
    EXPECT_EQ(names, (std::set<std::string>{"fig4-wide.pdf", "fig4-wide.svg", "fig4.pdf", "fig4.svg", "fig5-wide.pdf",
                                            "fig5-wide.svg", "fig5.pdf", "fig5.svg"}));
    EXPECT_NE(content_of(out / "figures/fig4.svg").find("<svg"), std::string::npos);
    EXPECT_NE(content_of(out / "figures/fig5.pdf").find("%PDF"), std::string::npos);
    EXPECT_NE(md.find("](figures/fig5-wide.svg)"), std::string::npos);
  } else {
    EXPECT_NE(md.find("were left out: "), std::string::npos);
  }
}

TEST_F(ReportFiles, NoPictureOfAnOlderReportStandsBesideNewTables) {
  const fs::path out = dir_ / "out", old = out / "figures/stability-old-map.svg", notes = out / "figures/notes.txt";
  fs::create_directories(out / "figures");
  for (const fs::path& file : {old, notes}) std::ofstream(file) << "older";
  {
    const OnlyPrograms none(dir_ / "bin");
    write_report({run_}, out);
    EXPECT_FALSE(fs::exists(old));
    EXPECT_EQ(content_of(notes), "older");
    if (page_template().figures.empty()) GTEST_SKIP() << "no page";
    EXPECT_NE(content_of(out / "report.md")
                  .find("Figures were left out: Node 18 or later was not found, or failed (Debian: nodejs)."),
              std::string::npos);
    none.add("node", "exit 1");
    write_report({run_}, out);
  }
  EXPECT_NE(content_of(out / "report.md").find("Figures were left out: "), std::string::npos);
  EXPECT_EQ(std::distance(fs::directory_iterator(out / "figures"), {}), 1) << "only the notes";
}

TEST_F(ReportFiles, WithoutRsvgConvertThereIsNoPdf) {
  if (!can_draw()) GTEST_SKIP() << "no Node, rsvg-convert or page";
  fs::create_directories(dir_ / "bin");
  ASSERT_EQ(std::system(("ln -s \"$(command -v node)\" " + (dir_ / "bin/node").string()).c_str()), 0);
  const OnlyPrograms broken(dir_ / "bin");
  broken.add("rsvg-convert", "exit 1");
  write_report({run_}, {dir_ / "out"});
  EXPECT_TRUE(fs::exists(dir_ / "out/figures/fig4.svg"));
  EXPECT_FALSE(fs::exists(dir_ / "out/figures/fig4.pdf"));
  const std::string md = content_of(dir_ / "out" / "report.md");
  EXPECT_NE(md.find("](figures/fig4-wide.svg)"), std::string::npos);
  EXPECT_NE(md.find("PDF pictures were left out: rsvg-convert was not found (Debian: librsvg2-bin)."),
            std::string::npos);
}

TEST_F(ReportFiles, IsAFunctionOfTheFiles) {
  write_report({run_}, {dir_ / "a"});
  write_report({run_ / ""}, {dir_ / "b"});
  for (const auto& file : fs::recursive_directory_iterator(dir_ / "a"))
    if (file.is_regular_file()) {
      EXPECT_EQ(content_of(file.path()), content_of(dir_ / "b" / fs::relative(file.path(), dir_ / "a"))) << file.path();
    }
}

TEST_F(ReportFiles, SaysWhatCannotBeRead) {
  const auto message = [&](const fs::path& run) { return refusal([&] { write_report({run}, {dir_ / "out"}); }); };
  EXPECT_NE(message(dir_ / "nothing").find((dir_ / "nothing").string()), std::string::npos);
  EXPECT_NE(message(dir_).find(dir_.string()), std::string::npos) << "a folder without study.json";
  std::ofstream(dir_ / "bad.h5") << "not HDF5";
  EXPECT_NE(message(dir_ / "bad.h5").find("bad.h5"), std::string::npos);
  EXPECT_FALSE(fs::exists(dir_ / "out" / "report.md"));
}

}  // namespace
}  // namespace clothbench

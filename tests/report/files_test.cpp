// From result files to a folder of tables and figures.
#include <gtest/gtest.h>
#include <unistd.h>

#include <cstdlib>
#include <fstream>

#include "clothbench/error.hpp"
#include "fake_runs.hpp"
#include "report/web/page.hpp"
#include "results/store.hpp"
#include "with_folder.hpp"

namespace clothbench {
namespace {

namespace fs = std::filesystem;

class ReportFiles : public WithFolder {
 protected:
  void SetUp() override {
    WithFolder::SetUp();
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

  std::string text(const fs::path& file) const {
    std::ifstream in(file, std::ios::binary);
    EXPECT_TRUE(in.good()) << file;
    return {std::istreambuf_iterator<char>(in), {}};
  }

  fs::path run_;
};

/// Programs of the PATH while it lives: none but what is put into its folder.
class OnlyPrograms {
 public:
  explicit OnlyPrograms(const fs::path& dir) : dir_(dir), before_(std::getenv("PATH")) {
    fs::create_directories(dir);
    setenv("PATH", dir.c_str(), 1);
  }
  ~OnlyPrograms() { setenv("PATH", before_.c_str(), 1); }
  OnlyPrograms(const OnlyPrograms&) = delete;
  OnlyPrograms& operator=(const OnlyPrograms&) = delete;
  void add(const std::string& name, const std::string& script) const {
    std::ofstream(dir_ / name) << "#!/bin/sh\n" << script << "\n";
    fs::permissions(dir_ / name, fs::perms::owner_all);
  }

 private:
  fs::path dir_;
  std::string before_;
};

bool can_draw() {
  return !page_template().figures.empty() && std::system("node --version >/dev/null 2>&1") == 0 &&
         std::system("rsvg-convert --version >/dev/null 2>&1") == 0;
}

TEST_F(ReportFiles, PlannedRunsWithoutAFileAreMissing) {
  const std::vector<RunRecord> runs = collect({run_});
  ASSERT_EQ(runs.size(), 5u);
  EXPECT_EQ(runs[3].outcome.status, "missing");
  EXPECT_EQ(runs[3].header.solver, "paper");
  EXPECT_EQ(runs[3].header.setting, "readback=blocking");
  EXPECT_EQ(entry(table_of(runs, "Frames per second, capped at 72"), "paper readback=blocking", "single", "9²"),
            "missing");
  const Table failed = table_of(runs, "Runs without a result");
  ASSERT_EQ(failed.rows.size(), 4u);
  EXPECT_TRUE(
      contains(failed.rows, std::vector<std::string>{"paper", "missing", "planned, not run", "gravity-77-single"}));
}

TEST_F(ReportFiles, WritesEveryFile) {
  const fs::path out = dir_ / "it's a report";
  write_report({run_}, {out});
  for (const char* file : {"report.md", "tables.tex", "runs.csv", "runs.json", "series.csv", "trials.csv"})
    EXPECT_GT(fs::file_size(out / file), 0u) << file;
  const std::string md = text(out / "report.md");
  EXPECT_NE(md.find("diverged at 3"), std::string::npos);
  EXPECT_NE(md.find("planned, not run"), std::string::npos);
  EXPECT_EQ(md.find("gravity-77-single"), md.rfind("gravity-77-single"))
      << "a scene without runs has nothing to tabulate";
  EXPECT_EQ(parse_csv(text(out / "runs.csv")).size(), 6u);
  if (can_draw()) {
    EXPECT_NE(text(out / "fig4.svg").find("<svg"), std::string::npos);
    EXPECT_NE(text(out / "fig5-wide.png").find("PNG"), std::string::npos);
    EXPECT_NE(text(out / "fig5.pdf").find("%PDF"), std::string::npos);
    EXPECT_NE(md.find("](fig5-wide.svg)"), std::string::npos);
  } else {
    EXPECT_NE(md.find("were left out: "), std::string::npos);
  }
}

TEST_F(ReportFiles, ThePicturesOfAnOlderReportGoAndTheUsersStay) {
  if (!can_draw()) GTEST_SKIP() << "no Node, rsvg-convert or page";
  const fs::path out = dir_ / "out";
  fs::create_directories(out);
  std::ofstream(out / "report-pictures.json")
      << R"({"format":"clothbench-report-pictures","format_version":1,"pictures":["fig4.svg","stability-old-map.svg","stability-old-map.png"]})";
  for (const char* name : {"fig4.svg", "stability-old-map.svg", "stability-old-map.png"})
    std::ofstream(out / name) << "an older figure";
  for (const char* name : {"penetration-notes.png", "stability-mine.svg", "work-precision-mine.png"})
    std::ofstream(out / name) << "the user's";
  write_report({run_}, {out});
  for (const char* name : {"penetration-notes.png", "stability-mine.svg", "work-precision-mine.png"})
    EXPECT_EQ(text(out / name), "the user's") << name;
  EXPECT_NE(text(out / "fig4.svg").find("<svg"), std::string::npos);
  EXPECT_FALSE(fs::exists(out / "stability-old-map.svg")) << "an older figure stands beside new tables";
  EXPECT_FALSE(fs::exists(out / "stability-old-map.png"));
  const nlohmann::json list = nlohmann::json::parse(text(out / "report-pictures.json"));
  EXPECT_EQ(list.at("pictures"),
            (nlohmann::json{"fig4-wide.pdf", "fig4-wide.png", "fig4-wide.svg", "fig4.pdf", "fig4.svg", "fig5-wide.pdf",
                            "fig5-wide.png", "fig5-wide.svg", "fig5.pdf", "fig5.svg"}));
}

TEST_F(ReportFiles, AUsersPictureIsNotWrittenOver) {
  if (!can_draw()) GTEST_SKIP() << "no Node, rsvg-convert or page";
  const fs::path out = dir_ / "out";
  fs::create_directories(out);
  std::ofstream(out / "fig5.svg") << "the user's";
  try {
    write_report({run_}, {out});
    ADD_FAILURE() << "written over";
  } catch (const Error& e) {
    EXPECT_NE(std::string(e.what()).find((out / "fig5.svg").string()), std::string::npos) << e.what();
  }
  EXPECT_EQ(text(out / "fig5.svg"), "the user's");
  EXPECT_FALSE(fs::exists(out / "fig4.svg")) << "half of the pictures were put in place";
}

TEST_F(ReportFiles, WhatCannotBeDrawnLeavesTheOlderPictures) {
  if (!can_draw()) GTEST_SKIP() << "no Node, rsvg-convert or page";
  const fs::path out = dir_ / "out";
  write_report({run_}, {out});
  const std::string picture = text(out / "fig4.svg"), list = text(out / "report-pictures.json");
  const auto left_out = [&](const std::string& why) {
    write_report({run_}, {out});
    EXPECT_EQ(text(out / "fig4.svg"), picture);
    EXPECT_EQ(text(out / "report-pictures.json"), list);
    EXPECT_NE(text(out / "report.md").find(why + " The pictures in this folder come from an earlier report."),
              std::string::npos);
  };
  {
    const OnlyPrograms none(dir_ / "bin");
    left_out("Figures were left out: Node 18 or later was not found (Debian: nodejs).");
    none.add("node", "[ \"$1\" = --version ]");
    left_out("Figures were left out: Node could not draw them; 18 or later is needed (Debian: nodejs).");
  }
  for (const auto& entry : fs::directory_iterator(out)) EXPECT_FALSE(entry.is_directory()) << entry.path();
}

TEST_F(ReportFiles, WithoutRsvgConvertThereIsNoPng) {
  if (!can_draw()) GTEST_SKIP() << "no Node, rsvg-convert or page";
  const OnlyPrograms broken(dir_ / "bin");
  broken.add("node",
             "[ \"$1\" = --version ] || { : >\"$3/fig4.svg\"; : >\"$3/hero.html\"; echo '![Drawn](fig4.svg)' "
             ">\"$3/figures.md\"; }");
  broken.add("rsvg-convert", "exit 1");
  write_report({run_}, {dir_ / "out"});
  EXPECT_TRUE(fs::exists(dir_ / "out" / "fig4.svg"));
  EXPECT_FALSE(fs::exists(dir_ / "out" / "fig4.png"));
  const std::string md = text(dir_ / "out" / "report.md");
  EXPECT_NE(md.find("## Figures\n\n![Drawn](fig4.svg)"), std::string::npos);
  EXPECT_NE(md.find("PNG and PDF pictures were left out: rsvg-convert was not found (Debian: librsvg2-bin)."),
            std::string::npos);
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

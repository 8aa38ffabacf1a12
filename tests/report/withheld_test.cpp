// What must not be printed isn't, in no table and no file, and they say why: times that were not taken alone, values by
// an older version of a metric's rule.
#include "report/withheld.hpp"

#include <gtest/gtest.h>
#include <unistd.h>

#include <fstream>

#include "fake_runs.hpp"
#include "metrics/registry.hpp"
#include "report/compare_runs.hpp"
#include "report/in_short.hpp"
#include "report/leak.hpp"
#include "report/penetration.hpp"
#include "results/store.hpp"

namespace clothbench {
namespace {

namespace fs = std::filesystem;

RunRecord with_jobs(RunRecord c, double jobs) {
  c.summary["jobs"] = jobs;
  return c;
}

TEST(Withheld, TimesNotTakenAloneAreGoneFromEveryTableOfTimes) {
  std::vector<RunRecord> runs = {with_jobs(fake_run("alone", 8, "single", 0.002), 1),
                                 with_jobs(fake_run("crowd", 8, "single", 0.002), 11),
                                 with_jobs(fake_run("older", 8, "single", 0.002), kMissing)};
  withhold(runs);
  for (const char* table : {"Table 3", "uncapped", "Wall time", "GPU time", "Peak bandwidth"}) {
    const Table t = table_of(runs, table);
    EXPECT_NE(entry(t, "alone", "single", "8²"), "–") << table;
    EXPECT_EQ(entry(t, "crowd", "single", "8²"), "–") << table;
    EXPECT_NE(entry(t, "older", "single", "8²"), "–") << table << ": its file does not know";
    EXPECT_NE(t.note.find("up to 11 jobs ran side by side"), std::string::npos) << t.note;
  }
  EXPECT_NE(entry(table_of(runs, "kB a frame"), "crowd", "single", "8²"), "–") << "bytes are no time";
  EXPECT_NE(entry(table_of(runs, "Free-fall"), "crowd", "single", "8²"), "–");
  EXPECT_EQ(table_of(runs, "Free-fall").note.find("jobs"), std::string::npos);
  const std::string head = headline(runs, Format::Markdown);
  EXPECT_NE(head.find("Not printed (–), 1 run: not timed alone: up to 11 jobs ran side by side."), std::string::npos)
      << head;
  EXPECT_NE(head.find("1 of the timed runs is from files that do not state"), std::string::npos) << head;
}

TEST(Withheld, FilesForMachinesHaveTheReasonInsteadOfTheTime) {
  std::vector<RunRecord> runs = {with_jobs(fake_run("crowd", 8, "single", 0.002), 4)};
  withhold(runs);
  const auto rows = parse_csv(runs_csv(runs));
  const auto at = [&](const std::string& name) {
    return rows.at(1).at(static_cast<std::size_t>(std::find(rows[0].begin(), rows[0].end(), name) - rows[0].begin()));
  };
  for (const char* time :
       {"fps_median", "frame_wall_median_s", "frame_device_median_s", "bandwidth_read_peak_B_per_s", "load_s"})
    EXPECT_EQ(at(time), "") << time;
  EXPECT_EQ(at("jobs"), "4");
  EXPECT_EQ(at("withheld"), "not timed alone: up to 4 jobs ran side by side");
  EXPECT_NE(at("free_fall_error"), "");
  const nlohmann::json j = runs_json(runs)[0];
  EXPECT_TRUE(j["summary"]["frame_wall_median_s"].is_null());
  EXPECT_EQ(j["withheld"]["frame_wall_median_s"], "not timed alone: up to 4 jobs ran side by side");
  EXPECT_NE(table3_csv(families(runs).at(0), published_table3()).find("not timed alone"), std::string::npos);
}

TEST(Withheld, TrialsOfSuchRunsCompareWithNothing) {
  std::vector<RunRecord> runs = {with_jobs(fake_run("s", 8, "single", 0.002), 2)},
                         alone = {with_jobs(fake_run("s", 8, "single", 0.002), 1)};
  for (auto* run : {&runs, &alone})
    for (int k = 0; k < 5; ++k) {
      TimedTrial t;
      t.frame_wall_s = {1e-3 * (k + 1)};
      run->front().trials.push_back(t);
    }
  withhold_times(runs);
  withhold_times(alone);
  EXPECT_EQ(in_short_table(runs).rows[1][5], "–");
  EXPECT_NE(in_short_table(runs).note.find("2 jobs"), std::string::npos);
  EXPECT_NE(in_short_table(alone).rows[1][5], "–");
  const auto tables = comparison_tables(compare_runs({alone}, {runs}));
  EXPECT_EQ(tables[0].rows.size(), 1u);
  EXPECT_NE(tables[0].note.find("2 jobs"), std::string::npos) << tables[0].note;
}

TEST(Withheld, EveryDocumentOfAReportLacksThem) {
  const fs::path dir = fs::temp_directory_path() / ("clothbench-withheld-" + std::to_string(getpid()));
  fs::create_directories(dir / "run");
  StudyManifest manifest{"table3", "", "", nlohmann::json::object(), {}};
  for (const int jobs : {1, 6}) {
    const RunRecord c =
        with_jobs(fake_run(jobs == 1 ? "alone" : "crowd", 8, "single", jobs == 1 ? 0.0011111 : 0.0077777), jobs);
    RunWriter(dir / "run", c.header).finish(c.outcome, c.summary);
    manifest.runs.push_back(run_name(c.header));
  }
  write_manifest(dir / "run", manifest);
  write_report({dir / "run"}, {dir / "report"});
  int files = 0;
  for (const auto& file : fs::recursive_directory_iterator(dir / "report")) {
    const std::string kind = file.path().extension().string();
    if (kind != ".md" && kind != ".csv" && kind != ".json" && kind != ".html") continue;
    std::ifstream in(file.path());
    const std::string text{std::istreambuf_iterator<char>(in), {}};
    EXPECT_EQ(text.find("0.0077777"), std::string::npos) << file.path();
    EXPECT_EQ(text.find("7.78"), std::string::npos) << file.path();
    EXPECT_EQ(text.find("128.57"), std::string::npos) << file.path() << ": frames per second";
    files += text.find("0.0011111") != std::string::npos;
  }
  EXPECT_GE(files, 3) << "runs.csv, runs.json, table3.json";
  testing::internal::CaptureStdout();
  print_console_report({dir / "run"});
  const std::string console = testing::internal::GetCapturedStdout();
  EXPECT_EQ(console.find("7.78"), std::string::npos);
  EXPECT_NE(console.find("6 jobs"), std::string::npos);
  fs::remove_all(dir);
}

TEST(Withheld, BytesThatAreALowerBoundSaySo) {
  std::vector<RunRecord> runs = {fake_run("a", 8, "single", 0.002), fake_run("b", 8, "single", 0.002)};
  runs[0].header.stages = {{"Lines", {}, 1, "computed"}, {"Contact", {}, 1, "at least"}};
  runs[1].header.stages = {{"Lines", {}, 1, "computed"}};
  EXPECT_EQ(entry(table_of(runs, "kB a frame"), "a", "single", "8²"), "≥ 16.0 / 8.00");
  EXPECT_EQ(entry(table_of(runs, "kB a frame"), "b", "single", "8²"), "16.0 / 8.00");
  EXPECT_EQ(entry(table_of(runs, "Peak bandwidth"), "a", "single", "8²"), "≥ 4.00 / 2.00");
  EXPECT_NE(table_of(runs, "kB a frame").note.find("computed"), std::string::npos);
}

}  // namespace
}  // namespace clothbench

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

RunRecord swept(const std::string& solver, double speed, int version, double samples, double inside_kept = 1) {
  RunRecord c = fake_run(solver, 32, "double", 0.004);
  c.header.scene = fmt::format("sweep-{:g}", speed);
  c.header.scenario_json =
      R"({"name":"sweep","cloth":{"grid":[32,32],"sides":"double"},"colliders":[{"type":"hand_capsules"}],)"
      R"("expect":{"wrong_side_samples_max":{"at_most":0},"depth_vertex_max_m":{"at_most":0.001}}})";
  c.accuracy.time_s = {0, 1};
  c.accuracy.metrics = {{"wrong_side_samples", "1", "", {0, samples}, version},
                        {"depth_vertex_m", "m", "", {0, 0}},
                        {"contact_length_m", "m", "", {0, 0}, metric_version("contact_length_m")}};
  c.summary["imposed_speed_m_per_s"] = speed;
  c.summary["wrong_side_samples_max"] = samples;
  c.summary["depth_vertex_max_m"] = inside_kept == 1 ? 0 : 0.002;
  c.summary["contact_length_max_m"] = 0.25;
  c.summary["contact_violated_longest_s"] = 1;
  c.summary["expect.wrong_side_samples_max"] = samples == 0;
  c.summary["expect.depth_vertex_max_m"] = inside_kept;
  c.outcome.expect =
      samples == 0 ? "pass"
                   : fmt::format("fail: depth_vertex_max_m 0.002 > 0.001; wrong_side_samples_max {:g} > 0", samples);
  return c;
}

TEST(Withheld, TwoVersionsOfARuleAreNotInOneTable) {
  std::vector<RunRecord> runs = {swept("now", 1, metric_version("wrong_side_samples"), 7), swept("before", 1, 1, 9, 0),
                                 swept("before", 2, 1, 0)};
  withhold(runs);
  const auto ups = set_ups(runs);
  const Table t = contact_table(ups.at(0));
  EXPECT_EQ(entry(t, "sweep-1", "now", "wrong side [samples]"), "7");
  EXPECT_EQ(entry(t, "sweep-1", "before", "wrong side [samples]"), "–");
  EXPECT_EQ(entry(t, "sweep-1", "before", "longest contour [s]"), "–") << "computed from it too";
  EXPECT_EQ(entry(t, "sweep-1", "before", "contour, greatest / settled [mm]"), "250 / –") << "another metric";
  EXPECT_NE(t.note.find("wrong_side_samples was measured by version 1 of its definition; the newest here is 3"),
            std::string::npos)
      << t.note;
  const Table v = verdict_table(ups);
  EXPECT_EQ(entry(v, "sweep-1", "fail", "before"), "fail") << "a bound that does not hang on it is broken";
  EXPECT_EQ(verdict(runs[2]), "–");
  EXPECT_NE(v.note.find("version 1"), std::string::npos) << v.note;
  EXPECT_EQ(runs[1].outcome.expect, "fail: depth_vertex_max_m 0.002 > 0.001");
  EXPECT_EQ(runs[2].outcome.expect, "not measured");
  for (const MetricSeries& m : runs[1].accuracy.metrics) EXPECT_NE(m.name, "wrong_side_samples") << "nor is its series";
  EXPECT_EQ(runs_json(runs)[1]["metric_versions"].contains("wrong_side_samples"), false);
  EXPECT_EQ(runs_json(runs)[0]["metric_versions"]["wrong_side_samples"], 3);
  EXPECT_EQ(penetration_json(ups)[0]["withheld"],
            "wrong_side_samples was measured by version 1 of its definition; the newest here is 3");
}

TEST(Withheld, TheFirstSpeedThatFailsIsUnknownWhereALowerOneIs) {
  std::vector<RunRecord> runs;
  for (const double speed : {1.0, 2.0, 5.0}) {
    runs.push_back(swept("before", speed, 1, 0, speed == 2 ? 0 : 1));
    runs.push_back(swept("sure", speed, speed == 5 ? 1 : 3, speed == 2));
  }
  withhold(runs);
  const Table t = leak_table(speed_sweeps(set_ups(runs)));
  ASSERT_EQ(t.rows.size(), 2u);
  EXPECT_EQ(t.rows[1][3], "–") << "at 1 m/s nothing is known";
  EXPECT_EQ(t.rows[1][4], "2 m/s: wrong side 1");
  EXPECT_NE(t.note.find("version 1"), std::string::npos) << t.note;
}

TEST(Withheld, AVersionNewerThanThisProgramsCountsTheMost) {
  std::vector<RunRecord> runs = {swept("now", 1, 3, 7), swept("later", 1, 4, 7)};
  withhold(runs);
  EXPECT_EQ(runs[0].withheld.at("wrong_side_samples_max"),
            "wrong_side_samples was measured by version 3 of its definition; the newest here is 4");
  EXPECT_TRUE(runs[1].withheld.empty());
}

TEST(Withheld, RunsByTwoVersionsAreNotCompared) {
  const std::vector<RunRecord> a = {swept("s", 1, 1, 9)}, b = {swept("s", 1, 2, 7)};
  const Comparison both = compare_runs({a}, {b});
  const std::vector<ComparedRun>& runs = both.runs;
  ASSERT_EQ(runs[0].versions.size(), 1u);
  for (const auto& m : runs[0].metrics) EXPECT_EQ(m.name.find("wrong_side"), std::string::npos) << m.name;
  const Table t = comparison_tables(both)[1];
  EXPECT_EQ(t.rows.back(), (std::vector<std::string>{"sweep-1__s__default", "wrong_side_samples", "by version 1",
                                                     "by version 2: not compared"}));
  EXPECT_EQ(comparison_json(both)["runs"][0]["versions"]["wrong_side_samples"], (nlohmann::json{1, 2}));
  EXPECT_TRUE(compare_runs({b}, {b}).runs[0].versions.empty());
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

#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "report/compare_runs.hpp"

namespace clothbench {
namespace {

TEST(CompareTimes, ApartAsFarAsCanBe) {
  const TimeRatio t = compare_times({1, 2, 3, 4, 5}, {11, 12, 13, 14, 15});
  EXPECT_NEAR(t.p, 2.0 / 252, 1e-12) << "one of 10 over 5 orders at either end";
  EXPECT_NEAR(t.level, 1 - 8.0 / 252, 1e-12) << "1 + 1 + 2 orders have U < 3";
  EXPECT_FALSE(t.noise());
  EXPECT_GT(t.low, 1);
  EXPECT_NEAR(compare_times({11, 12, 13, 14, 15}, {1, 2, 3, 4, 5}).ratio, 1 / t.ratio, 1e-12);
}

TEST(CompareTimes, AlikeOrTooFewIsNoise) {
  const TimeRatio alike = compare_times({1, 1, 1, 1, 1}, {1, 1, 1, 1, 1});
  EXPECT_TRUE(alike.noise());
  EXPECT_EQ(alike.p, 1);
  EXPECT_EQ(alike.ratio, 1);
  const TimeRatio few = compare_times({1, 1.1, 1.2}, {5, 6, 7});
  EXPECT_NEAR(few.p, 2.0 / 20, 1e-12);
  EXPECT_NEAR(few.level, 1 - 2.0 / 20, 1e-12);
  EXPECT_TRUE(few.noise());
  EXPECT_TRUE(compare_times({}, {1}).noise());
}

TEST(CompareTimes, IsRightAsOftenAsItSays) {
  std::mt19937 random(7);
  std::lognormal_distribution<double> spread(0, 0.05);
  int called = 0, covered = 0;
  constexpr int kRuns = 4000;
  constexpr double kTrue = 1.1;
  for (int run = 0; run < kRuns; ++run) {
    std::vector<double> a, b, slower;
    for (int k = 0; k < 5; ++k) {
      a.push_back(spread(random));
      b.push_back(spread(random));
      slower.push_back(kTrue * b.back());
    }
    called += !compare_times(a, b).noise();
    const TimeRatio t = compare_times(a, slower);
    covered += t.low <= kTrue && kTrue <= t.high;
  }
  // Exact levels at 5 and 5: U < 3 has 8 of 252 orders on both sides. Four standard deviations of 4000 runs.
  const double level = 8.0 / 252, four = 4 * std::sqrt(level * (1 - level) / kRuns);
  EXPECT_NEAR(called / double{kRuns}, level, four);
  EXPECT_NEAR(1 - covered / double{kRuns}, level, four);
}

RunRecord run(const std::string& scene, double frame_s, double error) {
  RunRecord c;
  c.header.scene = scene;
  c.header.solver = "s";
  c.header.setting = "default";
  for (int k = 0; k < 5; ++k) {
    TimedTrial t;
    t.index = k;
    t.frame_wall_s.assign(4, frame_s * (1 + 0.01 * k));
    c.trials.push_back(t);
  }
  c.summary = {{"free_fall_error", error}, {"fps_median", 1 / frame_s}};
  return c;
}

TEST(CompareRuns, TellsTimesResultsAndOutcomesApart) {
  const std::vector<RunRecord> a = {run("same", 1e-3, 0.5), run("slower", 1e-3, 0.5), run("fails", 1e-3, 0.5),
                                    run("gone", 1e-3, 0.5)};
  std::vector<RunRecord> b = {run("same", 1e-3, 0.5), run("slower", 2e-3, 0.25), run("fails", 1e-3, 0.5),
                              run("new", 1e-3, 0.5)};
  b[2].outcome.status = "diverged";
  b[2].outcome.klass = "F1";
  const char* kOfMachine[] = {"frame_cpu_median_s", "frame_rendered_median_s",   "stage_device_median_s.Lines",
                              "untimed_s",          "cpu_clock_end_Hz",          "temperature_start_C",
                              "sampled_fps_mean",   "expect.frame_wall_median_s"};
  for (const char* name : kOfMachine) b[1].summary[name] = 7;
  const auto runs = compare_runs(a, b);
  ASSERT_EQ(runs.size(), 5u);
  EXPECT_TRUE(runs[0].time.noise() && runs[0].metrics.empty() && runs[0].outcome.empty());
  EXPECT_FALSE(runs[1].time.noise());
  EXPECT_NEAR(runs[1].time.ratio, 2, 1e-12);
  ASSERT_EQ(runs[1].metrics.size(), 1u) << "rates are the machine's";
  EXPECT_EQ(runs[1].metrics[0].name, "free_fall_error");
  EXPECT_EQ(runs[2].outcome, "ok → diverged (F1)");
  EXPECT_EQ(runs[3].b, nullptr);
  EXPECT_EQ(runs[4].a, nullptr);
  const std::string text = comparison_tables(runs)[0].markdown() + comparison_tables(runs)[1].markdown();
  for (const char* word : {"noise", "slower", "+100.0 %", "free_fall_error", "diverged (F1)", "gone__s__default"})
    EXPECT_NE(text.find(word), std::string::npos) << word << "\n" << text;
  EXPECT_EQ(comparison_json(runs)[0]["verdict"], "noise");
}

/// Positions are compared where a result differs, by the mechanism of all pairs of runs.
TEST(CompareRuns, SaysHowFarApartTheMotionsAre) {
  const auto moved = [](double by_m, double error) {
    RunRecord c = run("sheet", 1e-3, error);
    c.header.vertices = 2;
    c.header.scenario_json = R"({"cloth": {"size_m": [2, 1]}})";
    c.accuracy.time_s = {0, 1};
    c.accuracy.position = {0, 0, 0, 2, 0, 0, 0, static_cast<float>(by_m), 0, 2, 0, 0};
    return c;
  };
  const auto apart = [&](double by_m, double error) {
    const std::vector<RunRecord> a = {moved(0, 0.5)}, b = {moved(by_m, error)};
    return compare_runs(a, b)[0].apart;
  };
  EXPECT_NEAR(apart(0.5, 0.25), 0.25, 1e-6) << "half a metre over the longer side of 2 m";
  EXPECT_EQ(apart(0, 0.25), 0);
  EXPECT_TRUE(std::isnan(apart(0.5, 0.5))) << "no value differs: not read";
  const std::vector<RunRecord> a = {moved(0, 0.5)}, b = {moved(0.5, 0.25)};
  EXPECT_NE(comparison_tables(compare_runs(a, b))[1].markdown().find("apart over L"), std::string::npos);
  std::vector<RunRecord> other = b;
  other[0].accuracy.position.resize(6);
  EXPECT_TRUE(std::isnan(compare_runs(a, other)[0].apart)) << "other frames cannot be compared";
}

TEST(History, IsWhatChartToolsRead) {
  const auto j = history_json({run("x", 2e-3, 0.5)});
  ASSERT_EQ(j.size(), 2u);
  EXPECT_EQ(j[0]["name"], "x__s__default frame");
  EXPECT_EQ(j[0]["unit"], "ms");
  EXPECT_NEAR(j[0]["value"].get<double>(), 2.04, 1e-9);
  EXPECT_EQ(j[1]["value"], 0.5);
}

}  // namespace
}  // namespace clothbench

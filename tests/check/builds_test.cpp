#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "check/compare.hpp"
#include "clothbench/error.hpp"
#include "refusal.hpp"

namespace clothbench {
namespace {

const std::vector<double> kFive = {1, 1.1, 1.2, 1.3, 1.4};

std::vector<double> scaled(std::vector<double> times, double by) {
  for (double& t : times) t *= by;
  return times;
}

TEST(CompareTimes, ApartAsFarAsCanBe) {
  const TimeRatio t = compare_times(kFive, scaled(kFive, 10));
  EXPECT_NEAR(t.p, 2.0 / 252, 1e-12) << "one assignment of 252 at either end";
  EXPECT_FALSE(t.noise());
  EXPECT_NEAR(t.ratio, 10, 1e-12);
  EXPECT_TRUE(t.low > 1 && t.low < 10 && t.high > 10);
  const TimeRatio back = compare_times(scaled(kFive, 10), kFive);
  EXPECT_NEAR(back.ratio, 0.1, 1e-12);
  EXPECT_NEAR(back.low, 1 / t.high, 1e-12);
  EXPECT_NEAR(back.p, t.p, 1e-12);
}

TEST(CompareTimes, TooFewProcessesSayNothing) {
  const std::vector<double> four(kFive.begin(), kFive.begin() + 4);
  for (const auto& [a, b] : {std::pair(four, scaled(kFive, 10)), std::pair(kFive, scaled(four, 10))}) {
    const TimeRatio t = compare_times(a, b);
    EXPECT_FALSE(t.enough());
    EXPECT_TRUE(t.noise());
    EXPECT_TRUE(std::isnan(t.p) && std::isnan(t.low) && std::isnan(t.high));
    EXPECT_GT(t.ratio, 5) << "the change is printed nevertheless";
  }
  EXPECT_TRUE(compare_times({}, {1}).noise());
  EXPECT_THROW(compare_times(std::vector<double>(kMaxProcesses + 1, 1.0), kFive), Error);
}

TEST(CompareTimes, IntervalAndProbabilityAgree) {
  std::mt19937 random(3);
  std::normal_distribution<double> spread(0, 0.02);
  for (int k = 0; k < 300; ++k) {
    std::vector<double> a, b;
    for (int i = 0; i < 5 + k % 3; ++i) a.push_back(std::exp(spread(random)));
    for (int i = 0; i < 5 + k % 4; ++i) b.push_back(std::exp(0.03 + spread(random)));
    const TimeRatio t = compare_times(a, b);
    EXPECT_EQ(t.noise(), !(t.p <= 0.05)) << t.p << " " << t.low << " " << t.high;
  }
}

/// Relative standard deviations: between processes, between trials in a process, between frames in a trial.
struct Spread {
  double process, trial, frame;
  bool heavy = false;  ///< one process in ten is 20 % slower
};

RunRecord drawn_run(const Spread& s, double frame_s, std::mt19937& random) {
  std::normal_distribution<double> normal;
  RunRecord r;
  r.header.scene = "drawn";
  const double slow = s.heavy && std::uniform_real_distribution<double>()(random) < 0.1 ? 1.2 : 1;
  const double of_process = frame_s * slow * std::exp(s.process * normal(random));
  for (int k = 0; k < 3; ++k) {
    TimedTrial& t = r.trials.emplace_back();
    const double of_trial = of_process * std::exp(s.trial * normal(random));
    for (int f = 0; f < 6; ++f) t.frame_wall_s.push_back(of_trial * std::exp(s.frame * normal(random)));
  }
  return r;
}

/// Fraction of `repeats` comparisons that report a change: `count` processes at 1 ms per frame against as many at
/// `frame_s` per frame.
double called(const Spread& s, std::size_t count, double frame_s, int repeats, std::mt19937& random) {
  int n = 0;
  for (int k = 0; k < repeats; ++k) {
    std::vector<RunRecord> a, b;
    for (std::size_t i = 0; i < count; ++i) {
      a.push_back(drawn_run(s, 1e-3, random));
      b.push_back(drawn_run(s, frame_s, random));
    }
    std::vector<const RunRecord*> p, q;
    for (const RunRecord& r : a) p.push_back(&r);
    for (const RunRecord& r : b) q.push_back(&r);
    n += !compare_times(process_times(p), process_times(q)).noise();
  }
  return n / static_cast<double>(repeats);
}

constexpr Spread kSpreads[] = {{0, 0.01, 0.05},    {0.01, 0.01, 0.05}, {0.05, 0.01, 0.05},
                               {0.02, 0.005, 0.3}, {0.2, 0.01, 0.01},  {0.01, 0.01, 0.05, true}};

/// 5 % +- 2 % of comparisons of a build with itself report a difference, however processes, trials and frames vary.
TEST(CompareTimes, FalseAlarmsAreAsRareAsStated) {
  std::mt19937 random(11);
  for (const std::size_t count : {std::size_t{5}, std::size_t{6}})
    for (const Spread& s : kSpreads) {
      const double rate = called(s, count, 1e-3, 2000, random);
      EXPECT_TRUE(rate >= 0.03 && rate <= 0.07) << count << " processes, " << s.process << " of processes: " << rate;
    }
}

/// With 5 processes per side, about four of five comparisons find a change of twice the standard deviation between
/// processes, and almost all find a change of three times it. With 8 processes almost all find the smaller change.
TEST(CompareTimes, FindsChangesOfTheSizeStated) {
  std::mt19937 random(12);
  const Spread s = {0.02, 0.001, 0.001};
  EXPECT_GE(called(s, 5, 1e-3 * std::exp(2 * s.process), 1000, random), 0.7);
  EXPECT_GE(called(s, 5, 1e-3 * std::exp(3 * s.process), 1000, random), 0.95);
  EXPECT_GE(called(s, 8, 1e-3 * std::exp(2 * s.process), 300, random), 0.93);
}

RunRecord run(const std::string& scene, double frame_s, double error) {
  RunRecord c;
  c.header.scene = scene;
  c.header.solver = "s";
  c.header.setting = "default";
  c.header.scenario_sha256 = "5ce2e";
  c.header.environment = {{"cpu", "CPU one"}, {"gpu", "GPU one"}, {"precision", "float32"}};
  for (int k = 0; k < 5; ++k) {
    TimedTrial t;
    t.index = k;
    t.frame_wall_s.assign(4, frame_s * (1 + 0.01 * k));
    c.trials.push_back(t);
  }
  c.summary = {{"free_fall_error", error}, {"fps_median", 1 / frame_s}};
  return c;
}

/// The same runs in several processes, each a little slower than the previous one.
Processes processes(const std::vector<RunRecord>& runs, int count = 5) {
  Processes out;
  for (int k = 0; k < count; ++k) {
    out.push_back(runs);
    for (RunRecord& r : out.back())
      for (TimedTrial& t : r.trials) t.frame_wall_s = scaled(t.frame_wall_s, 1 + 0.001 * k);
  }
  return out;
}

TEST(CompareRuns, TellsTimesResultsAndOutcomesApart) {
  const Processes a =
      processes({run("same", 1e-3, 0.5), run("slower", 1e-3, 0.5), run("fails", 1e-3, 0.5), run("gone", 1e-3, 0.5)});
  std::vector<RunRecord> changed = {run("same", 1e-3, 0.5), run("slower", 2e-3, 0.25), run("fails", 1e-3, 0.5),
                                    run("new", 1e-3, 0.5)};
  changed[2].outcome.status = "diverged";
  changed[2].outcome.klass = "F1";
  const char* kOfMachine[] = {"frame_cpu_median_s",        "frame_rendered_median_s", "untimed_s",
                              "cpu_clock_end_Hz",          "temperature_start_C",     "sampled_fps_mean",
                              "expect.frame_wall_median_s"};
  for (const char* name : kOfMachine) changed[1].summary[name] = 7;
  const Processes b = processes(changed);
  const Checked all = compare_processes(a, b);
  const auto& runs = all.runs;
  ASSERT_EQ(runs.size(), 5u);
  EXPECT_TRUE(runs[0].time.noise() && runs[0].findings.empty());
  EXPECT_FALSE(runs[1].time.noise());
  EXPECT_NEAR(runs[1].time.ratio, 2, 1e-12);
  ASSERT_EQ(runs[1].findings.size(), 1u) << "rates are the machine's";
  EXPECT_EQ(runs[1].findings[0].quantity, "free_fall_error");
  EXPECT_EQ(runs[2].findings.at(0).baseline + " → " + runs[2].findings.at(0).found, "ok → diverged F1");
  EXPECT_EQ(runs[3].findings.at(0).found, "–");
  EXPECT_EQ(runs[4].findings.at(0).baseline, "–");
  for (const CheckedRun& run : runs)
    for (const Finding& f : run.findings) EXPECT_EQ(f.verdict, Verdict::Changed);
  const std::string text = comparison_text(all);
  for (const char* word : {"noise", "slower", "+100.0 %", "free_fall_error", "diverged F1", "gone__s__default"})
    EXPECT_NE(text.find(word), std::string::npos) << word << "\n" << text;
  EXPECT_EQ(comparison_json(all)["runs"][0]["time"]["verdict"], "noise");
  EXPECT_TRUE(comparison_json(all)["overridden"].empty());
}

TEST(CompareRuns, ResultsHaveATolerance) {
  for (const double factor : {1 + 1e-12, 1 + 1e-6}) {
    const Processes a = {{run("x", 1e-3, 0.5)}}, b = {{run("x", 1e-3, 0.5 * factor)}};
    EXPECT_EQ(compare_processes(a, b).runs[0].findings.empty(), factor < 1 + 1e-9);
  }
  const Processes a = {{run("x", 1e-3, 0.5)}}, b = {{run("x", 1e-3, std::nan(""))}};
  EXPECT_EQ(compare_processes(a, b).runs[0].findings.at(0).found, "not measured");
}

TEST(CompareRuns, OneProcessASideMakesNoStatement) {
  const Processes a = processes({run("x", 1e-3, 0.5)}, 1), b = processes({run("x", 9e-3, 0.5)}, 1);
  const nlohmann::json row = comparison_json(compare_processes(a, b))["runs"][0]["time"];
  EXPECT_EQ(row["verdict"], "too few processes: 5 per side needed");
  EXPECT_TRUE(row["p"].is_null());
}

TEST(CompareRuns, OtherConditionsAreRefusedByNameUnlessAllowed) {
  const struct {
    const char *kind, *a, *b;  ///< both values in the error message
    void (*change)(RunRecord&);
  } all[] = {{"scene", "5ce2e", "07e4", [](RunRecord& r) { r.header.scenario_sha256 = "07e4"; }},
             {"machine", "CPU one", "CPU two", [](RunRecord& r) { r.header.environment["cpu"] = "CPU two"; }},
             {"device", "GPU one", "GPU two", [](RunRecord& r) { r.header.environment["gpu"] = "GPU two"; }},
             {"device", "–", "1.2", [](RunRecord& r) { r.header.environment["driver"] = "1.2"; }},
             {"precision", "float32", "float64", [](RunRecord& r) { r.header.environment["precision"] = "float64"; }},
             {"length", "0", "1", [](RunRecord& r) { r.accuracy.time_s.assign(2, 0); }},
             {"trials", "4", "3", [](RunRecord& r) {
                for (TimedTrial& t : r.trials) t.frame_wall_s.resize(3);
              }}};
  const Processes a = processes({run("x", 1e-3, 0.5)});
  for (const auto& other : all) {
    Processes b = a;
    for (auto& process : b) other.change(process[0]);
    const std::string why = refusal([&] { compare_processes(a, b); }, ExitCode::BadInput);
    for (const char* word : {other.kind, other.a, other.b, "x__s__default", "--allow"})
      EXPECT_PRED2(mentions, why, word);
    for (const std::string& wrong : condition_kinds()) {
      if (wrong == other.kind) continue;
      EXPECT_THROW(compare_processes(a, b, {wrong}), Error) << "another kind than " << other.kind << " was allowed";
    }
    const Checked allowed = compare_processes(a, b, {other.kind});
    EXPECT_NE(allowed.differing.marks().find(other.b), std::string::npos);
    EXPECT_EQ(comparison_json(allowed)["overridden"][0]["kind"], other.kind);
    const std::string table = comparison_text(allowed);
    EXPECT_NE(table.find(std::string("other ") + other.kind), std::string::npos) << table;
  }
}

TEST(CompareRuns, ProcessesOneAfterTheOtherMakeNoStatement) {
  const auto started = [](Processes side, double first_s, double step_s) {
    for (std::size_t k = 0; k < side.size(); ++k)
      for (TimedTrial& t : side[k][0].trials) t.start_unix_s = first_s + step_s * static_cast<double>(k);
    return side;
  };
  const Processes one = processes({run("x", 1e-3, 0.5)}), other = processes({run("x", 2e-3, 0.5)});
  const Processes a = started(one, 0, 2), turns = started(other, 1, 2), after = started(other, 100, 2);
  EXPECT_EQ(comparison_json(compare_processes(a, turns))["runs"][0]["time"]["verdict"], "slower");
  const std::string without = comparison_json(compare_processes(a, after))["runs"][0]["time"]["verdict"];
  EXPECT_NE(without.find("one after the other"), std::string::npos) << without;
  const Processes mixed = started(other, 5, 1), inside = started(other, 0.5, 0.1);
  EXPECT_EQ(comparison_json(compare_processes(a, mixed))["runs"][0]["time"]["verdict"], "slower") << "changes often";
  EXPECT_EQ(comparison_json(compare_processes(a, inside))["runs"][0]["time"]["verdict"], without) << "changes twice";
  const nlohmann::json allowed = comparison_json(compare_processes(a, after, {"order"}));
  EXPECT_EQ(allowed["runs"][0]["time"]["verdict"], "slower; other order");
  EXPECT_EQ(allowed["overridden"][0]["kind"], "order");
}

TEST(CompareRuns, ProcessesOfOneSideMustAgreeToo) {
  Processes a = processes({run("x", 1e-3, 0.5)});
  const Processes b = a;
  a[3][0].header.environment["cpu"] = "CPU two";
  EXPECT_THROW(compare_processes(a, b), Error);
}

TEST(CompareRuns, ARunThatFailedIsNoOtherLength) {
  const Processes a = processes({run("x", 1e-3, 0.5)});
  Processes b = a;
  for (auto& process : b) {
    process[0].outcome.status = "diverged";
    process[0].accuracy.time_s = {0};
  }
  EXPECT_EQ(compare_processes(a, b).runs[0].findings.at(0).found, "diverged");
}

TEST(CompareRuns, OtherScenesAreNamedByTheirKeys) {
  Processes a = processes({run("x", 1e-3, 0.5)}), b = a;
  a[0][0].header.scenario_json = R"({"cloth": {"grid": [8, 8]}})";
  for (auto& process : b) {
    process[0].header.scenario_json = R"({"cloth": {"grid": [24, 8]}})";
    process[0].header.scenario_sha256 = "07e4";
  }
  EXPECT_PRED2(mentions, refusal([&] { compare_processes(a, b); }), "/cloth/grid/0: 8, 24");
}

/// Positions are compared where a result differs.
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
    const Processes a = {{moved(0, 0.5)}}, b = {{moved(by_m, error)}};
    const Checked compared = compare_processes(a, b);
    for (const Finding& f : compared.runs[0].findings)
      if (f.quantity.starts_with("positions")) return f.found;
    return std::string("none");
  };
  EXPECT_EQ(apart(0.5, 0.25), "0.25") << "half a metre over the longer side of 2 m";
  EXPECT_EQ(apart(0, 0.25), "0");
  EXPECT_EQ(apart(0.5, 0.5), "none") << "no value differs: not read";
  Processes a = {{moved(0, 0.5)}}, b = {{moved(0.5, 0.25)}};
  b[0][0].accuracy.position.resize(6);
  EXPECT_EQ(compare_processes(a, b).runs[0].findings.size(), 1u) << "other frames cannot be compared";
}

}  // namespace
}  // namespace clothbench

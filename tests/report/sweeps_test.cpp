// What the tables of --full's sweeps say: pulled strips, popping at 16 times the substeps, cloths turned over.
#include <gtest/gtest.h>
#include <unistd.h>

#include <cmath>
#include <filesystem>
#include <fstream>

#include "clothbench/error.hpp"
#include "fake_runs.hpp"
#include "report/contact_pairs.hpp"
#include "report/pulled_strip.hpp"
#include "report/report.hpp"
#include "results/store.hpp"

namespace clothbench {
namespace {

namespace fs = std::filesystem;

RunRecord pulled(const std::string& solver, double speed, double error) {
  RunRecord c = fake_run(solver, 32, "single", 0.004);
  c.header.scene = "two-hand-pull-at-" + std::to_string(speed);
  c.header.scenario_json =
      R"({"name":"two-hand-pull","cloth":{"grid":[33,5],"sides":"single"},"grips":[{"edge":"u0","v":)" +
      std::to_string(speed) + R"(}],"truth":{"case":"two-hand-pull"},"time":{"frame_rate_hz":960}})";
  // As the motion gives it, not as the file says it.
  c.summary = {{"imposed_speed_m_per_s", speed * (1 + 1e-12)},
               {"truth_quantity_error_max", error},
               {"truth_quantity_error", error / 2},
               {"truth_e2", 1e-5 * speed},
               {"expect.truth_quantity_error", error <= 0.1 ? 1 : 0}};
  return c;
}

TEST(PulledStrip, SaysWhichSpeedFailsFirst) {
  std::vector<RunRecord> runs = {pulled("a", 30, 0.3),       pulled("a", 0.5, 0.05), pulled("a", 10, 0.11),
                                 pulled("b", 0.5, kMissing), pulled("b", 10, 0.01),  pulled("c", 0.5, 0.1),
                                 pulled("c", 30, 0.02),      pulled("d", 10, 0.01)};
  runs.back().outcome = {"not_finite", "F0", 7, "", {}};
  const auto ups = set_ups(runs);
  ASSERT_EQ(ups.size(), 1u);
  EXPECT_EQ(ups[0].kind, "wave");
  const Table t = pulled_strip_table(ups);
  ASSERT_EQ(t.rows.size(), 5u);
  EXPECT_EQ(t.rows[0], (std::vector<std::string>{"strip", "solver", "failure speed", "0.5 m/s", "10 m/s", "30 m/s"}));
  EXPECT_EQ(t.rows[1], (std::vector<std::string>{"two-hand-pull 33×5", "a", "10 m/s", "0.05 / 5.0e-06",
                                                 "0.11 / 1.0e-04", "0.3 / 3.0e-04"}));
  EXPECT_EQ(t.rows[2][2], "0.5 m/s") << "what is not known fails";
  EXPECT_EQ(t.rows[2][3], "– / 5.0e-06");
  EXPECT_EQ(t.rows[3][2], "none up to 30 m/s") << "0.1 is allowed";
  EXPECT_EQ(t.rows[4][4], "not_finite");
  EXPECT_EQ(t.rows[4][2], "10 m/s");
  const auto j = pulled_strip_json(ups);
  EXPECT_EQ(j[0]["first_fault_m_per_s"].get<double>(), 10 * (1 + 1e-12));
  EXPECT_TRUE(j[2]["first_fault_m_per_s"].is_null());
  EXPECT_TRUE(j[1]["speeds"][0]["strain_error_max"].is_null());
  EXPECT_EQ(pulled_strip_table({}).rows.size(), 1u);
}

RunRecord popping_run(const std::string& solver, const std::string& setting, double pop_m) {
  RunRecord c = fake_run(solver, 32, "double", 0.004);
  c.header.scene = "sweep-2mps";
  c.header.setting = setting;
  c.header.scenario_json =
      R"({"name":"sweep","cloth":{"grid":[32,32],"sides":"double"},"colliders":[{"type":"hand_capsules"}]})";
  c.summary = {{"pop_max_m", pop_m}};
  return c;
}

TEST(Popping, IsComparedWithTheSameSolverInSmallerSteps) {
  std::vector<RunRecord> runs = {
      popping_run("a", "default", 0.0119),   popping_run("a", "x16", 0.002), popping_run("b", "default", 0.0121),
      popping_run("b", "x16", 0.002),        popping_run("c", "default", 0), popping_run("c", "x16", 0.02),
      popping_run("d", "default", kMissing), popping_run("d", "x16", 0.01),  popping_run("e", "default", 0.01),
      popping_run("f", "default", 0.01),     popping_run("f", "x16", 0.01)};
  runs.back().outcome = {"diverged", "F1", 3, "", {}};
  const auto all = popping_pairs(set_ups(runs));
  ASSERT_EQ(all.size(), 5u) << "e has no finer one";
  const Table t = popping_table(all);
  const std::vector<std::string> expected = {"pass", "fail", "pass", "not known", "did not run"};
  for (std::size_t k = 0; k < all.size(); ++k) {
    EXPECT_EQ(t.rows[k + 1].back(), expected[k]) << all[k].series.solver;
    EXPECT_EQ(popping_passed(all[k]), expected[k] == "pass");
  }
  EXPECT_EQ(t.rows[1], (std::vector<std::string>{"sweep-2mps", "a", "11.9", "2.00", "pass"}));
  EXPECT_EQ(t.rows[5][3], "diverged");
  EXPECT_EQ(popping_json(all)[3]["pop_max_m"], nullptr);
}

/// Two columns, three rows; in the turned one the grid is three by two, and its vertices lie where those lay.
RunRecord lying(const std::string& scene, bool transposed, float off_m) {
  RunRecord c = fake_run("a", 32, "double", 0.004);
  c.header.scene = scene;
  c.header.vertices = 6;
  c.header.scenario_json =
      std::string(R"({"name":"lying","cloth":{"grid":)") + (transposed ? "[3,2]" : "[2,3]") +
      R"(,"size_m":[1,2],"sides":"double"},"colliders":[{"type":"mesh"}],"expect":{"crossings_max":{"at_most":0}}})";
  c.summary = {{"crossings_max", 0}, {"expect.crossings_max", 1}};
  c.accuracy.time_s = {0, 0.05, 0.1, 0.3};  // touches at 0.05
  c.accuracy.metrics = {{"touching_fraction", "1", "", {0, 0.1, 0.1, 0}}};
  for (int frame = 0; frame < 4; ++frame)
    for (int v = 0; v < 6; ++v) {
      const int u = transposed ? v / 3 : v % 2, w = transposed ? v % 3 : v / 2;
      const float off = frame < 2 ? 0 : frame == 2 ? off_m : 3 * off_m;
      for (const float x : {static_cast<float>(u), static_cast<float>(w), u == 1 && w == 2 ? off : 0.0f})
        c.accuracy.position.push_back(x);
    }
  return c;
}

TEST(Turned, VerticesOfTheSamePlaceAreCompared) {
  std::vector<RunRecord> runs = {lying("drop", false, 0), lying("drop-turned", true, 0.12f), lying("other", false, 0)};
  auto pairs = turned_pairs(set_ups(runs));
  ASSERT_EQ(pairs.size(), 1u) << "the other has not been turned";
  EXPECT_NEAR(pairs[0].value, 0.12 / std::sqrt(6.0) / 2, 1e-7);
  EXPECT_NEAR(turned_json(pairs)[0]["apart_end"].get<double>(), 0.36 / std::sqrt(6.0) / 2, 1e-7);
  EXPECT_TRUE(same_from_both_sides(pairs[0]));
  EXPECT_EQ(turned_table(pairs).rows[1].back(), "same");
  runs[1] = lying("drop-turned", true, 0.3f);
  EXPECT_FALSE(same_from_both_sides(turned_pairs(set_ups(runs))[0]))
      << "an RMS distance of 0.12 is over a twentieth of 2";
  runs[1] = lying("drop-turned", true, 0);
  EXPECT_TRUE(same_from_both_sides(turned_pairs(set_ups(runs))[0]));
  runs[1].summary["expect.crossings_max"] = 0;
  EXPECT_FALSE(same_from_both_sides(turned_pairs(set_ups(runs))[0])) << "it leaks from this side alone";
  runs[0].summary["expect.crossings_max"] = 0;
  EXPECT_TRUE(same_from_both_sides(turned_pairs(set_ups(runs))[0])) << "a leak is a leak from either side";
  runs[0].accuracy.metrics[0].values = {0, 0, 0, 0};
  EXPECT_FALSE(same_from_both_sides(turned_pairs(set_ups(runs))[0])) << "it never touched";
  runs[0].accuracy.metrics = {};
  EXPECT_FALSE(same_from_both_sides(turned_pairs(set_ups(runs))[0])) << "whether it did is not known";
  runs[0] = runs[2];
  runs[0].header.scene = "drop";
  runs[1].accuracy.position.pop_back();
  EXPECT_FALSE(same_from_both_sides(turned_pairs(set_ups(runs))[0])) << "not known is not the same";
  EXPECT_EQ(turned_json(turned_pairs(set_ups(runs)))[0]["apart_end"], nullptr);
}

TEST(Pairs, AreThoseThatTheStudyNames) {
  std::vector<RunRecord> runs = {popping_run("a", "default", 0.0119), popping_run("a", "fine", 0.01),
                                 popping_run("a", "x16", 0.01), popping_run("b", "coarse", 0.0119)};
  EXPECT_EQ(run_pairs(runs, "finer").size(), 1u) << "x16, as studies of version 0.1 call it";
  nlohmann::json pair = {{"relation", "finer"},
                         {"with", {{"scene", {"sweep-2mps"}}, {"setting", {"coarse", "default"}}}}};
  runs[1].header.environment["pairs"] = {pair};
  auto pairs = run_pairs(runs, "finer");
  ASSERT_EQ(pairs.size(), 2u);
  for (const RunPair& p : pairs) EXPECT_EQ(p.run, &runs[0]);
  EXPECT_EQ(pairs[0].other, &runs[1]);
  runs[3] = popping_run("a", "coarse", 0.0119);
  EXPECT_EQ(run_pairs(runs, "finer")[1].run, &runs[3]) << "the first of the names that was run";
  EXPECT_TRUE(run_pairs(runs, "scale").empty());
  std::ifstream in(CLOTHBENCH_SOURCE_DIR "/scenarios/schema/study.schema.json");
  for (const auto& name : nlohmann::json::parse(in)["definitions"]["pair"]["properties"]["relation"]["enum"])
    EXPECT_NO_THROW(run_pairs(runs, name.get<std::string>()));
  EXPECT_THROW(run_pairs(runs, "unknown"), Error);
}

/// A report of files: errors of a pulled strip without timed runs are given by speed, of one with them by time.
TEST(PulledStrip, UntimedOnesAreNoDiagram) {
  const fs::path dir = fs::temp_directory_path() / ("clothbench-pulled-strip-" + std::to_string(::getpid()));
  fs::remove_all(dir);
  std::vector<fs::path> files;
  for (const bool timed : {false, true}) {
    RunRecord c = pulled("a", timed ? 10 : 2, 0.02);
    c.header.vertices = 1;
    c.header.settings = nlohmann::json::object();
    if (timed) c.summary["frame_wall_median_s"] = 1e-3;
    c.summary["truth_error"] = 0.01;
    c.summary["reference_uncertainty"] = 1e-6;
    RunWriter writer(dir / "run", c.header);
    writer.write_accuracy({{0, 1}, {0, 0, 0, 1, 0, 0}, {}});
    files.push_back(writer.finish(c.outcome, c.summary));
  }
  write_report(files, {dir / "report"});
  const auto text = [&](const char* name) {
    std::ifstream in(dir / "report" / name);
    return std::string(std::istreambuf_iterator<char>(in), {});
  };
  const auto penetration = nlohmann::json::parse(text("penetration.json")),
             work = nlohmann::json::parse(text("work-precision.json"));
  ASSERT_EQ(penetration["pulled_strip"].size(), 1u);
  EXPECT_EQ(penetration["pulled_strip"][0]["speeds"].size(), 1u);
  ASSERT_EQ(work.size(), 1u);
  EXPECT_EQ(work[0]["points"].size(), 1u);
  fs::remove_all(dir);
}

}  // namespace
}  // namespace clothbench

// Contents of the penetration tables, of files and of the feature table.
#include <gtest/gtest.h>

#include <cmath>

#include "clothbench/feature.hpp"
#include "fake_runs.hpp"

namespace clothbench {
namespace {

/// A run of a desk drop with the given part of the room.
RunRecord desk_run(const std::string& solver, const std::string& setting, const std::string& cut) {
  RunRecord c = fake_run(solver, 32, "double-duplicated", 0.004);
  c.header.scene = "desk-flat-low";
  c.header.setting = setting;
  c.header.scenario_json =
      R"({"name":"desk-flat-low","paper":{"section":"4.2","table":5},"cloth":{"grid":[32,32],"sides":"double-duplicated"},
    "colliders":[{"type":"room","cut":")" +
      cut +
      R"("}],"expect":{"outcome":"ok","crossings_max":{"at_most":0},"stretch_max":{"at_least":0.5,"at_most":1}}})";
  c.header.stages = {{"Integrate", {}, 1}, {"Mesh", {"static_mesh", "friction"}, 1}};
  c.header.environment["solver_features"] = {
      {"supports", {"static_mesh", "friction", "sphere"}},
      {"ignores", nlohmann::json::array()},
      {"only_with", nlohmann::json::array({nlohmann::json::array({"static_mesh", "duplicated_layer"})})}};
  c.summary["crossings_max"] = 0;
  c.summary["contact_length_max_m"] = 0.0123;
  c.summary["contact_length_settled_m"] = 0;
  c.summary["depth_max_m"] = 3e-6;
  c.summary["expect.crossings_max"] = 1;
  c.summary["expect.outcome"] = 1;
  c.header.vertices = 2;
  c.accuracy.time_s = {0, 1.0 / 72};
  c.accuracy.position = {0, 0, 0, 1, 0, 0, 0, 0, 0, 1, 0, 0};
  c.accuracy.metrics = {{"contact_length_m", "m", "", {0, 0.0123}}, {"depth_m", "m", "", {0, kMissing}}};
  return c;
}

RunRecord of_scene(RunRecord c, const std::string& scene, const std::string& scenario) {
  c.header.scene = scene;
  c.header.scenario_json = scenario;
  return c;
}

constexpr const char* kContact = "Contact";
constexpr const char* kVerdicts = "Verdict on the acceptance criteria of each scene";

TEST(Penetration, ABoundThatIsNotMeasuredIsNoFailureAnywhere) {
  RunRecord c = desk_run("xpbd", "default", "none");
  c.summary["expect.stretch_max"] = kMissing;
  c.header.scenario_json.insert(1, R"("time":{"duration_s":2},)");
  EXPECT_TRUE(tables_titled({c}, "Acceptance criteria that are violated").empty());
  const RunTable table({c});
  EXPECT_EQ(tiles_of(table).at(0).entries[0].value, "0/1") << "a run that was not measured has not passed";
  EXPECT_EQ(verdict_cell(table.rows()[0]).why, "the untimed run covers 0.0139 s of 2 s");
  std::string all;
  for (const View& v : views())
    for (const Table& t : tables_of(v, table)) all += t.markdown();
  for (const char* word : {" nan", "(nan", " inf", "(inf"}) EXPECT_EQ(all.find(word), std::string::npos) << word;
}

TEST(Penetration, VerdictsHaveAColumnForEverySettingAndASum) {
  const std::vector<RunRecord> runs = {
      desk_run("xpbd", "default", "any_vertex_inside"), desk_run("paper", "whole-room", "none"),
      with_outcome(desk_run("bullet-deformable", "default", "any_vertex_inside"), "unsupported", -1, "not built"),
      of_scene(desk_run("xpbd", "default", ""), "ball", R"({"colliders":[{"type":"sphere"}]})")};
  const Table t = table_of(runs, kVerdicts);
  using Cells = std::vector<std::vector<std::string>>;
  EXPECT_EQ(t.rows, (Cells{{"scene", "bullet-deformable", "paper whole-room", "xpbd"},
                           {"ball", "not run", "not run", "pass"},
                           {"desk-flat-low", "unsupported", "pass", "pass"},
                           {"all", "unsupported", "pass", "2/2 (34–100 %)"}}));
}

TEST(Penetration, SeriesHaveOneRowPerFrame) {
  const auto csv = parse_csv(series_csv(RunTable({desk_run("xpbd", "default", "none")})));
  ASSERT_EQ(csv.size(), 3u);
  for (const auto& row : csv) ASSERT_EQ(row.size(), csv[0].size());
  EXPECT_EQ(field(csv, 2, "time_s"), "0.0138889");
  EXPECT_EQ(field(csv, 2, "contact_length_m"), "0.0123");
  EXPECT_EQ(field(csv, 2, "depth_m"), "") << "NaN is missing";
}

TEST(Features, ComeFromTheResultFilesAlone) {
  std::vector<RunRecord> runs = {
      desk_run("paper", "default", "none"),
      with_outcome(desk_run("absent", "default", "none"), "unsupported", -1, "not in this build"),
      desk_run("ignorant", "default", "none")};
  runs[1].header.environment.erase("solver_features");
  runs[2].header.environment["solver_features"] = {
      {"supports", {"plane"}}, {"ignores", {"sphere"}}, {"only_with", nlohmann::json::array()}};
  const Table t = table_of(runs, "Table 4: features");
  const auto text = [&](const std::string& feature, std::size_t column) {
    for (const auto& row : t.rows)
      if (row[0] == feature) return row.at(column);
    return std::string("no row");
  };
  EXPECT_EQ(t.rows.at(0), (std::vector<std::string>{"feature", "absent", "ignorant", "paper"}));
  EXPECT_EQ(t.rows.size(), kFeatureCount + 1);
  EXPECT_EQ(text("plane", 1), "not built");
  EXPECT_EQ(text("sphere", 2), "ignored");
  EXPECT_EQ(text("plane", 2), "yes");
  EXPECT_EQ(text("static mesh", 3), "yes (only with duplicated layer)");
  EXPECT_EQ(text("friction", 3), "yes");
  EXPECT_EQ(text("sphere", 3), "yes");
  EXPECT_EQ(text("plane", 3), "no");
}

TEST(Penetration, TablesStateTheContactOffset) {
  const std::string scenario = R"({"cloth":{"grid":[8,8]},"colliders":[{"type":"box","margin_m":0.004}]})";
  std::vector<RunRecord> runs = {of_scene(desk_run("xpbd", "default", ""), "box", scenario),
                                 of_scene(desk_run("other", "default", ""), "box", scenario),
                                 of_scene(desk_run("none", "default", ""), "box", scenario)};
  runs[1].header.plan["contact_margins"] = {{{"collider", "named otherwise"}, {"margin_m", 0.02}}};
  runs[2].outcome.status = "unsupported";
  const auto offset = [&](const std::string& solver) {
    return entry(table_of(runs, kContact), "box", solver, "contact offset [mm]");
  };
  EXPECT_EQ(offset("xpbd"), "4") << "the scene's margin";
  EXPECT_EQ(offset("other"), "20") << "what the solver states";
  EXPECT_EQ(offset("none"), "–");
  runs[1].header.plan["contact_margins"].push_back({{"collider", "box"}, {"margin_m", 0.0035}});
  EXPECT_EQ(offset("other"), "3.5 to 20");
}

constexpr const char* kRates = "Random scenes: pass rate";

RunRecord generated(const std::string& solver, const std::string& kind, int seed, double speed,
                    const std::string& ending, double contour = 0, const std::string& assets = "npm",
                    const std::string& study = "contact") {
  RunRecord c;
  c.header.solver = solver;
  c.header.setting = "default";
  c.header.scene = "contact-" + std::to_string(seed) + "-" + kind;
  c.header.environment = {{"protocol", "short"}};
  c.header.scenario_json =
      nlohmann::json{
          {"name", c.header.scene},
          {"seed", seed},
          {"drawn", {{"study", study}, {"kind", kind}, {"assets", assets}, {"speed_m_per_s", speed}, {"values", {}}}}}
          .dump();
  const bool ended = ending == "pass" || ending == "fail";
  c.outcome.status = ended ? "ok" : ending;
  c.outcome.expect = ending == "fail" ? "fail: contact_length_max_m" : ended ? ending : "not measured";
  c.summary["contact_length_max_m"] = contour;
  c.summary["expect.contact_length_max_m"] = !ended ? NAN : ending == "pass" ? 1 : 0;
  return c;
}

std::vector<RunRecord> sample() {
  return {generated("xpbd", "sweep", 1, 0.5, "pass"),        generated("xpbd", "sweep", 3, 1.99, "pass"),
          generated("xpbd", "sweep", 5, 2, "fail", 0.02),    generated("xpbd", "sweep", 7, 14, "fail", 0.3),
          generated("xpbd", "desk", 2, 6, "timed_out"),      generated("xpbd", "desk", 4, 6, "pass"),
          generated("paper", "desk", 2, 6, "unsupported"),   generated("paper", "desk", 4, 6, "crashed"),
          generated("paper", "sweep", 1, 0.5, "pass", 0.01), RunRecord{}};
}

TEST(PassRates, CountRunsThatDidNotEndAsNotPassed) {
  const Table t = table_of(sample(), kRates);
  EXPECT_EQ(t.rows[0],
            (std::vector<std::string>{"solver", "kind", "0–2 m/s", "2–5 m/s", "5–10 m/s", "≥ 10 m/s", "all"}));
  const auto rate = [&](const std::string& solver, const std::string& kind, const std::string& band) {
    return entry(t, solver, kind, band);
  };
  EXPECT_EQ(rate("xpbd", "sweep", "0–2 m/s"), "2/2 (34–100 %)");
  EXPECT_EQ(rate("xpbd", "sweep", "2–5 m/s"), "0/1 (0–79 %)") << "2 m/s is in the upper band";
  EXPECT_EQ(rate("xpbd", "sweep", "5–10 m/s"), "–");
  EXPECT_EQ(rate("xpbd", "sweep", "≥ 10 m/s"), "0/1 (0–79 %)");
  EXPECT_EQ(rate("xpbd", "sweep", "all"), "2/4 (15–85 %)");
  EXPECT_EQ(rate("xpbd", "desk", "5–10 m/s").substr(0, 3), "1/2") << "one timed out";
  EXPECT_EQ(rate("xpbd", "all", "all").substr(0, 3), "3/6");
  EXPECT_EQ(rate("paper", "all", "all").substr(0, 3), "1/3") << "one unsupported, one crashed";
  EXPECT_EQ(table_of({generated("xpbd", "desk", 1, 1, "pass", 0, "procedural")}, kRates).rows[1][1],
            "desk (procedural)");
  const RunRecord other = generated("xpbd", "desk", 1, 1, "pass", 0, "npm", "physics");
  EXPECT_EQ(tables_titled({sample()[0], other}, kRates).size(), 2u) << "studies are not added up";
  EXPECT_EQ(t.note.find("missing"), std::string::npos);
  EXPECT_EQ(t.note.find("leaves out"), std::string::npos);
  EXPECT_NE(table_of({sample()[0], sample()[4], sample()[6]}, kRates).note.find("leaves out paper (sweep)."),
            std::string::npos);
  std::vector<RunRecord> runs = sample();
  runs.front().outcome.status = "missing";
  EXPECT_NE(table_of(runs, kRates).note.find("1 of 9 runs are missing"), std::string::npos);
  runs = {generated("xpbd", "desk", 1, 1, "pass")};
  runs[0].header.plan["contact_margins"] = {{{"collider", "mesh"}, {"margin_m", 0.02}}};
  EXPECT_EQ(entry(table_of(runs, kRates), "xpbd", "desk", "contact offset [mm]"), "20");
}

/// A claim at a point of the box: `held` is 1, 0 or NaN; `dispatches` per frame.
RunRecord claim(const std::string& kind, int iterations, double held, double dispatches) {
  RunRecord c = generated("paper", kind, iterations, 0, "pass");
  nlohmann::json scenario = nlohmann::json::parse(c.header.scenario_json);
  scenario["seed"] = 2 * iterations + (kind == "c8");
  scenario["drawn"]["claims"] = 2;
  scenario["drawn"]["values"] = {{"paper.iterations", iterations}, {"cloth.size_m", 0.5}, {"friction", kind == "c8"}};
  scenario["drawn"]["settings"] = {{"paper", {{"iterations", iterations}, {"substeps", 2}}}};
  c.header.scenario_json = scenario.dump();
  c.header.scene += "-" + kind;
  c.summary["expect.contact_length_max_m"] = held;
  c.summary["expect.motion"] = 0;  // not part of a claim
  c.summary["dispatches"] = dispatches;
  return c;
}

constexpr const char* kClaimTable = "Claims of the article, over what it leaves open";
TEST(Claims, CountAPointOnceAndCompareItsDevices) {
  std::vector<RunRecord> runs = {claim("c8", 2, 0, 9), claim("c8", 2, 1, 9), claim("c8", 4, 1, 11)};
  for (RunRecord& r : runs) {
    r.header.environment["gpu_is_software"] = &r == runs.data();
    r.header.environment["gpu"] = &r == runs.data() ? "software" : "GPU";
    r.summary["frame_device_median_s"] = 1e-6 * r.summary["dispatches"];
  }
  const Table t = table_of(runs, kClaimTable);
  EXPECT_EQ(entry(t, "paper", "c8", "holds").substr(0, 3), "2/2") << "on the GPU";
  EXPECT_EQ(entry(t, "paper", "c8", "its GPU time [ms]"), "0.00900");
  const Table devices = table_of(runs, "Work and rate by device");
  ASSERT_EQ(devices.rows.size(), 5u) << "one run and the sum, on two devices";
  EXPECT_EQ(devices.rows[1], (std::vector<std::string>{"contact-2-c8-c8", "paper", "GPU", "9", "0.00900", "1.00"}));
}

TEST(Claims, CountPointsOfTheBoxAndNoRunOfTheHeadline) {
  const std::vector<RunRecord> runs = {claim("c8", 2, 0, 9),    claim("c10", 2, 1, 7),   claim("c8", 20, 1, 90),
                                       claim("c10", 20, 1, 70), claim("c8", 40, 1, 180), claim("c10", 40, NAN, 150),
                                       claim("c8", 100, 1, 400)};  // its other claim was not run
  const Table t = table_of(runs, kClaimTable);
  const auto cell = [&](const std::string& kind, const std::string& column) { return entry(t, "paper", kind, column); };
  EXPECT_EQ(cell("c8", "holds").substr(0, 3), "3/4");
  EXPECT_EQ(cell("c10", "holds").substr(0, 3), "2/3") << "a bound that was not measured does not hold";
  EXPECT_EQ(cell("all", "holds").substr(0, 3), "1/3") << "of the points with both claims";
  EXPECT_EQ(cell("all", "reading"), "reproducible");
  EXPECT_EQ(cell("all", "fewest dispatches"), "90") << "of the most expensive claim";
  EXPECT_EQ(cell("all", "best point"), "clothbench study contact --seed 40 --count 2");
  EXPECT_EQ(cell("c10", "best point"), "clothbench study contact --seed 4 --count 1");
  const Table contact = table_of(runs, "Contact");
  EXPECT_EQ(contact.rows.size(), 3u) << "the two scenes of that point";
  EXPECT_EQ(contact.rows[1][1], "paper, best");
  std::vector<RunRecord> elsewhere = runs;
  for (const int iterations : {20, 40}) {
    elsewhere.push_back(fake_run("paper", 32, "single", 1e-3));
    elsewhere.back().header.setting = fmt::format("iterations={}", iterations);
    elsewhere.back().header.settings = {{"iterations", iterations}, {"substeps", 2}, {"stiffness", 1}};
  }
  const Table table3 = table_of(elsewhere, "Table 3: speed and error");
  EXPECT_EQ(table3.rows[1][0], "paper, best") << "runs of other studies with the settings of that point";
  EXPECT_TRUE(table3.rows[2][0].starts_with("published"));
  // At the cheapest point one claim was not run, so it is unknown whether both hold there.
  const std::vector<RunRecord> apart = {claim("c8", 2, 0, 9), claim("c10", 2, 1, 7), claim("c8", 1, 1, 5)};
  EXPECT_EQ(entry(table_of(apart, kClaimTable), "paper", "all", "best point"),
            "1 of 2 claims: clothbench study contact --seed 4 --count 2");
  const std::vector<RunRecord> never = {claim("c8", 2, 1, 9), claim("c10", 20, 1, 7)};
  EXPECT_EQ(entry(table_of(never, kClaimTable), "paper", "all", "reading"), "–");
  EXPECT_EQ(entry(table_of(apart, kClaimTable), "paper", "all", "missed there").substr(0, 4), "c8: ");
  EXPECT_EQ(cell("c8", "at all points with"), "iterations ≥ 20 (3 points)");
  EXPECT_NE(t.note.find("; friction false to true; paper.iterations 2 to 100."), std::string::npos);
  RunRecord swept = claim("c10-sweep", 2, NAN, 7);
  swept.header.scenario_json.insert(1, R"("cloth":{"grid":[32,32]},)");
  swept.summary["roughness_end"] = 0.04;
  EXPECT_EQ(entry(table_of({swept}, kClaimTable), "paper", "c11-folds", "reading"), "reproduced");
  swept.summary["roughness_end"] = 0.05;
  EXPECT_EQ(entry(table_of({swept}, kClaimTable), "paper", "c11-folds", "reading"), "not reproduced in the box");
  RunRecord unbounded = claim("c8", 2, 1, 9);
  unbounded.summary.erase("expect.contact_length_max_m");
  EXPECT_EQ(entry(table_of({unbounded}, kClaimTable), "paper", "c8", "reading"), "not reproduced in the box");
  EXPECT_TRUE(tables_titled(runs, kRates).empty());
}

TEST(Stability, RunsOfEachCaseByGrade) {
  const auto judged = [](const std::string& solver, const std::string& kase, double grade, const std::string& klass) {
    RunRecord c = fake_run(solver, 8, "single", 1e-3);
    c.header.scene = kase + "-stiff-" + solver + klass;
    c.header.scenario_json = R"({"name":"s01-stiffness","stability":{"case":")" + kase + R"("}})";
    c.outcome = {klass == "F3" ? "crashed" : "ok", klass, klass == "ok" ? -1 : 7, "", {}};
    c.summary["stability_grade"] = grade;
    return c;
  };
  const std::vector<RunRecord> runs = {judged("a", "S01", 0, "ok"), judged("a", "S01", 2, "F1"),
                                       judged("a", "S02", 1, "F2"), judged("b", "S01", kMissing, "F3")};
  const Table t = table_of(runs, "Robustness");
  EXPECT_EQ(t.rows[0], (std::vector<std::string>{"case", "a", "b"}));
  EXPECT_EQ(t.rows[1],
            (std::vector<std::string>{"S01 stiffness", "1/2 stable, 1 failed (F1)", "0/1 stable, 1 failed (F3)"}));
  EXPECT_EQ(t.rows[2][1], "0/1 stable, 1 degraded (F2)");
  EXPECT_EQ(t.rows[3][0] + ": " + t.rows[3][1], "all: 1/3 stable, 1 degraded (F2), 1 failed (F1)");
  const Table failures = table_of(runs, "Runs that failed");
  ASSERT_EQ(failures.rows.size(), 4u);
  EXPECT_EQ(failures.rows[1], (std::vector<std::string>{"a", "ended, but failed (F1)", "S01-stiff-aF1 (frame 7)"}));
  EXPECT_EQ(failures.rows[3], (std::vector<std::string>{"b", "crashed (F3)", "S01-stiff-bF3 (frame 7)"}));
}

}  // namespace
}  // namespace clothbench

// Which stiffness is a parameter, and what that does to the tables.
#include <gtest/gtest.h>

#include <cmath>

#include "metrics/truth_dependence.hpp"
#include "report/material.hpp"
#include "report/work_precision.hpp"
#include "scenario/load.hpp"

namespace clothbench {
namespace {

using nlohmann::json;

RunRecord measured(const std::string& solver, const std::string& setting, bool full,
                   std::map<std::string, double> moduli) {
  RunRecord c;
  c.header.scene = "effective-moduli";
  c.header.solver = solver;
  c.header.setting = setting;
  c.header.settings = json::object();
  c.header.scenario_json = full ? R"({"name":"effective-moduli","effective_moduli":"full"})"
                                : R"({"name":"effective-moduli","effective_moduli":"short"})";
  for (const auto& [name, value] : moduli) c.summary["material_" + name] = value;
  return c;
}

std::map<std::string, double> right() {
  return {{"E_0", 1}, {"E_strip", 1.01}, {"E_stiffer", 1}, {"B_0", 0.98}, {"B_stiffer", 0.98}};
}

MaterialVerdict verdict_of(const std::vector<RunRecord>& runs) { return solver_materials(runs).at(0).verdict; }

TEST(Verdict, AParameterIsHeardAndHeld) {
  std::vector<RunRecord> runs = {measured("a", "default", true, right()),
                                 measured("a", "substeps=40", false, {{"E_0", 1.04}, {"E_strip", 0.97}, {"B_0", 1}})};
  EXPECT_EQ(verdict_of(runs).strip + verdict_of(runs).sheet + verdict_of(runs).bending, "");
  runs[1].summary["material_E_0"] = 1.06;
  EXPECT_EQ(verdict_of(runs).strip, "");
  EXPECT_EQ(verdict_of(runs).sheet, "depends on settings: 1 at default, 1.06 at substeps=40");
  runs[1].summary["material_E_0"] = NAN;
  EXPECT_EQ(verdict_of(runs).sheet, "no value at substeps=40");
  runs[0].summary["material_E_stiffer"] = 0.5;  // what is measured does not change with Y
  EXPECT_NE(verdict_of(runs).strip, "");
  runs[0].summary["material_E_stiffer"] = NAN;
  EXPECT_NE(verdict_of(runs).strip, "");
  runs[0].summary["material_B_0"] = 0;
  EXPECT_EQ(verdict_of(runs).bending, "none: 0 of the requested stiffness");
}

TEST(Verdict, WithoutModuliNoSolverIsFlagged) {
  const auto full = solver_materials({});
  const StiffnessNeed strip{true, false, false};
  EXPECT_EQ(stiffness_flag(full, "a", "default", strip), "");
  const std::vector<RunRecord> runs = {measured("a", "substeps=2", false, right())};
  EXPECT_EQ(stiffness_flag(solver_materials(runs), "a", "substeps=2", strip), "")
      << "no measured at the default setting";
}

/// Scenes are not listed by hand: which stiffness a truth depends on is found by changing it.
TEST(Dependence, IsMeasuredOnEveryTruth) {
  const auto need_of = [](const std::string& name, const std::vector<std::string>& set = {}) {
    const Scene s = load_scene("validation/" + name, set);
    RunRecord c;
    c.header.scenario_json = s.json;
    c.summary = truth_dependence(s);
    const StiffnessNeed n = stiffness_need(c);
    return std::string(n.strip ? "strip " : "") + (n.sheet ? "sheet " : "") + (n.bending ? "bending" : "");
  };
  EXPECT_EQ(need_of("heavy-strip"), "strip ");
  EXPECT_EQ(need_of("two-hand-pull"), "strip ");
  for (const char* name : {"cantilever-1", "cantilever-10", "cantilever-100"})
    EXPECT_EQ(need_of(name), "bending") << name;
  for (const char* name : {"free-fall", "pendulum", "swing-strip", "incline-stick", "incline-slip", "incline-stop",
                           "capstan-hold", "capstan-slip"})
    EXPECT_EQ(need_of(name), "") << name;
  // The strip's stretch is rho g L^2 / 2 Y: a tenth more stiffness, an eleventh less stretch.
  const auto heavy = truth_dependence(load_scene("validation/heavy-strip"));
  EXPECT_NEAR(heavy.at("truth_dependence_Y"), (1 - 1 / 1.1) / std::log(1.1), 1e-6);
  EXPECT_EQ(need_of("heavy-strip", {"material.membrane_stiffness_N_per_m=1e5"}), "strip ")
      << "however little it stretches";
  EXPECT_TRUE(truth_dependence(load_scene("validation/hang")).empty()) << "no truth";
}

RunRecord run(const std::string& scene, const std::string& truth, const std::string& solver, double frame_s,
              double error, double device_s = NAN) {
  RunRecord c;
  c.header.scene = scene;
  c.header.solver = solver;
  c.header.setting = "default";
  c.header.settings = json::object();
  c.header.scenario_json =
      json{{"name", scene}, {"truth", {{"case", truth}}}, {"time", {{"frame_rate_hz", 60}}}}.dump();
  c.header.environment = {{"gpu", "CPU"}};
  c.summary = {{"frame_wall_median_s", frame_s},
               {"frame_device_median_s", device_s},
               {"truth_error", error},
               {"reference_uncertainty", 1e-7},
               {"truth_dependence_Y", truth == "heavy-strip" ? 1.0 : 0.0}};
  return c;
}

TEST(Verdict, UnrankedSolversAreShownButNeverFirst) {
  auto deaf = right();
  deaf["E_stiffer"] = 0.5;
  const std::vector<RunRecord> moduli = {measured("deaf", "default", true, deaf),
                                         measured("good", "default", true, right())};
  const auto materials = solver_materials(moduli);
  const std::vector<RunRecord> runs = {
      run("hang", "heavy-strip", "deaf", 1e-3, 1e-5), run("hang", "heavy-strip", "good", 2e-3, 5e-3, 1e-3),
      run("swing", "swing-strip", "deaf", 1e-3, 1e-5), run("swing", "swing-strip", "good", 2e-3, 5e-3)};
  const auto diagrams = work_diagrams(runs, materials);
  EXPECT_TRUE(diagrams[0].flagged.contains("deaf"));
  EXPECT_TRUE(diagrams[1].flagged.empty()) << "a swing asks for no stiffness";
  EXPECT_EQ(diagrams[0].best_error(), 5e-3);
  const Table t = work_table(diagrams);
  EXPECT_EQ(t.rows[1][1], "deaf");
  EXPECT_EQ(t.rows[1][11], "NO: stiffness is not a parameter");
  EXPECT_EQ(t.rows[1][2], "60 (default)") << "shown all the same";
  EXPECT_EQ(t.rows[2][9], "60 (default)") << "by the GPU's clock half of its wall time";
  EXPECT_EQ(t.rows[2][11], "yes");
  const Table first = winners_table(diagrams);
  EXPECT_EQ(first.rows[1][2], "good (1.2e+02)");
  EXPECT_EQ(first.rows[2][2], "deaf (60)");
  const Table ranks = ranks_table(diagrams);
  ASSERT_EQ(ranks.rows.size(), 3u);
  EXPECT_EQ(ranks.rows[1], (std::vector<std::string>{"deaf", "1", "1.00", "1.00", "1.00"}));
  EXPECT_EQ(ranks.rows[2], (std::vector<std::string>{"good", "2", "1.41", "1.41", "1.41"}))
      << "first of one, then second of two";
}

std::string strip_scene() {
  return json{{"name", "hang"},
              {"truth", {{"case", "heavy-strip"}}},
              {"material", {{"shear", false}}},
              {"time", {{"frame_rate_hz", 60}}}}
      .dump();
}

TEST(Verdict, EachSettingIsRankedByItsOwnModulus) {
  auto soft = right();
  soft["E_strip"] = 0.8;
  const std::vector<RunRecord> moduli = {measured("a", "default", true, right()), measured("a", "fast", false, soft)};
  std::vector<RunRecord> runs(3, run("hang", "heavy-strip", "a", 1e-3, 1e-5));
  runs[1].header.setting = "fast";  // quicker, and not ranked
  runs[1].summary["frame_wall_median_s"] = 1e-4;
  runs[2].header.setting = "unmeasured";
  for (RunRecord& r : runs) r.header.scenario_json = strip_scene();
  const auto materials = solver_materials(moduli);
  const auto diagrams = work_diagrams(runs, materials);
  EXPECT_TRUE(diagrams[0].flagged.empty()) << "one setting is ranked";
  EXPECT_EQ(work_table(diagrams).rows[1][11], "at 1 of 3 settings");
  EXPECT_EQ(winners_table(diagrams).rows[1][2], "a (60)") << "by the ranked setting";
  for (const WorkPoint& p : diagrams[0].points)
    EXPECT_EQ(p.not_ranked, p.setting == "default" ? "" : "depends on settings: 1.01 at default, 0.8 at fast");
}

TEST(Verdict, ThePlanOfARunComesFirst) {
  RunRecord r = run("hang", "heavy-strip", "a", 1e-3, 1e-5);
  const auto materials = solver_materials({});
  r.header.plan = {{"left_out", {{{"what", "threads"}, {"why", "too few"}, {"no_parameter", "sheet_Y"}}}}};
  r.header.scenario_json = strip_scene();
  EXPECT_EQ(stiffness_flag(materials, r), "") << "another stiffness";
  r.header.plan["left_out"][0]["no_parameter"] = "strip_Y";
  EXPECT_EQ(stiffness_flag(materials, r), "the run has no threads: too few");
}

TEST(Floors, ErrorsBelowTheMeshsOwnShareARank) {
  std::vector<RunRecord> runs = {run("s", "swing-strip", "a", 1e-3, 1e-4), run("s", "swing-strip", "b", 1e-3, 9e-4),
                                 run("s", "swing-strip", "c", 1e-3, 3e-3)};
  for (RunRecord& c : runs) c.summary["truth_space_error"] = 2e-3;
  const auto d = work_diagrams(runs);
  EXPECT_EQ(d[0].rank_floor(), 2e-3);
  EXPECT_EQ(work_table(d).rows[1][4], "≤ 0.002 (default)");
  EXPECT_EQ(work_table(d).rows[3][4], "0.003 (default)");
  EXPECT_EQ(winners_table(d).rows[1][4], "a, b (≤ 0.002)");
  EXPECT_EQ(ranks_table(d).rows[3][4], "3.00");
}

}  // namespace
}  // namespace clothbench

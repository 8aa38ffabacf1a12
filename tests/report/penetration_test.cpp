// What the penetration tables, files and the feature table say.
#include "report/penetration.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "fake_runs.hpp"
#include "report/contact_pairs.hpp"
#include "report/features.hpp"

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
  c.summary["stage_device_median_s.Mesh"] = 0.002;
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

/// Entry of the row of `scene` and `solver` under a heading.
std::string run_of(const Table& t, const std::string& scene, const std::string& solver, const std::string& head) {
  return entry(t, scene, solver, head);
}

TEST(Penetration, SetUpsAreToldByWhatTouches) {
  const RunRecord any = desk_run("xpbd", "default", "any_vertex_inside");
  const std::vector<RunRecord> runs = {
      any,
      of_scene(any, "free", R"({"cloth":{"grid":[8,8]},"colliders":[],"grips":[]})"),
      of_scene(any, "ball", R"({"colliders":[{"type":"sphere"}]})"),
      of_scene(any, "sweep", R"({"paper":{"section":"4.3","table":6},"colliders":[{"type":"hand_capsules"}]})"),
      of_scene(any, "push", R"({"colliders":[{"type":"plane"},{"type":"hand_mesh"}]})"),
      of_scene(any, "pull", R"({"paper":{"section":"4.4"},"grips":[{"track":"x"}]})"),
      of_scene(any, "sheet", R"({"colliders":[{"type":"mesh"}]})"),
      of_scene(any, "odd", "not JSON"),
      of_scene(any, "odder", R"({"colliders":3,"grips":"x"})"),
      of_scene(any, "oddest", R"({"colliders":[7]})")};
  EXPECT_FALSE(has_contact(runs[1]));
  const std::vector<ContactSetUp> ups = set_ups(runs);
  ASSERT_EQ(ups.size(), 5u);
  std::string text;
  for (const ContactSetUp& u : ups) {
    text += u.kind + ":";
    for (const ContactScene& s : u.scenes) text += " " + s.name;
    text += "; ";
  }
  EXPECT_EQ(text, "rooms: desk-flat-low sheet; capsules: sweep; hand: push; grip: pull; shapes: ball oddest; ");
  EXPECT_EQ(ups[0].title, "Cloth on static meshes (section 4.2, Table 5)");
  EXPECT_EQ(ups[3].title, "Hands hold and pull cloth (section 4.4)");
  for (const ContactSetUp& u : ups)
    for (const Table& t : std::vector<Table>{contact_table(u), cost_table(u)})
      for (const auto& row : t.rows) EXPECT_EQ(row.size(), t.rows[0].size()) << t.title;
}

TEST(Penetration, AStudySaysTheSetUp) {
  RunRecord c = desk_run("xpbd", "default", "any_vertex_inside");
  c.header.environment["set_up"] = "hand";
  const std::vector<RunRecord> runs = {c};
  EXPECT_EQ(set_ups(runs).at(0).kind, "hand") << "not of the room that it touches";
  EXPECT_EQ(set_ups(runs).size(), 1u);
}

TEST(Penetration, TableShowsNumbersInTheirUnits) {
  std::vector<RunRecord> runs = {desk_run("xpbd", "default", "any_vertex_inside"),
                                 desk_run("paper", "default", "any_vertex_inside")};
  runs[1].summary["crossings_max"] = 34;
  runs[1].summary["expect.crossings_max"] = 0;
  const Table t = contact_table(set_ups(runs).at(0));
  EXPECT_EQ(run_of(t, "desk-flat-low", "xpbd", "crossings"), "0");
  EXPECT_EQ(run_of(t, "desk-flat-low", "paper", "crossings"), "34");
  EXPECT_EQ(run_of(t, "desk-flat-low", "xpbd", "contour, greatest / settled [mm]"), "12.3 / 0");
  EXPECT_EQ(run_of(t, "desk-flat-low", "xpbd", "depth [mm]"), "<0.01") << "what is not nothing never reads as nothing";
  EXPECT_EQ(run_of(t, "desk-flat-low", "xpbd", "wall / GPU [ms]"), "4.00 / 3.60");
  EXPECT_EQ(run_of(t, "desk-flat-low", "xpbd", "verdict"), "pass");
  EXPECT_EQ(run_of(t, "desk-flat-low", "paper", "verdict"), "fail");
  EXPECT_EQ(t.markdown().find("self-contact"), std::string::npos) << "a column without a value is left out";
  EXPECT_EQ(t.markdown().find("nan"), std::string::npos);
  const Table broken = failed_expectations_table(set_ups(runs));
  ASSERT_EQ(broken.rows.size(), 2u);
  EXPECT_EQ(broken.rows[1], (std::vector<std::string>{"desk-flat-low", "paper", "crossings_max", "at most 0", "34"}));
}

TEST(Penetration, VerdictNeverHidesAFailure) {
  RunRecord c = desk_run("xpbd", "default", "none");
  EXPECT_EQ(verdict(c), "pass");
  RunRecord control = c;
  for (const FeatureRow& f : kFeatures) control.header.environment["solver_features"]["ignores"].push_back(f.name);
  EXPECT_EQ(verdict(control), "ignored") << "luck is no merit";
  control.summary["expect.stretch_max"] = 0;
  EXPECT_EQ(verdict(control), "fail");
  c.summary["expect.stretch_max"] = kMissing;
  EXPECT_EQ(verdict(c), "not measured");
  c.summary["expect.stretch_max"] = 0;
  EXPECT_EQ(verdict(c), "fail") << "also beside one that is not measured";
  EXPECT_EQ(verdict(with_outcome(c, "diverged", 17, "")), "diverged at 17");
  EXPECT_EQ(verdict(with_outcome(c, "unsupported", -1, "")), "unsupported");
  std::erase_if(c.summary, [](const auto& s) { return s.first.starts_with("expect."); });
  EXPECT_EQ(verdict(c), "–");
}

TEST(Penetration, OverviewHasAColumnForEverySetting) {
  std::vector<RunRecord> runs = {
      desk_run("xpbd", "default", "any_vertex_inside"), desk_run("paper", "whole-room", "none"),
      with_outcome(desk_run("bullet-deformable", "default", "any_vertex_inside"), "unsupported", -1,
                   "not in this build"),
      of_scene(desk_run("xpbd", "default", ""), "ball", R"({"colliders":[{"type":"sphere"}]})")};
  const auto rows = parse_markdown(verdict_table(set_ups(runs)).markdown());
  ASSERT_EQ(rows.size(), 3u);
  EXPECT_EQ(rows[0], (std::vector<std::string>{"scene", "bullet-deformable", "paper whole-room", "xpbd"}));
  EXPECT_EQ(rows[1], (std::vector<std::string>{"desk-flat-low", "unsupported", "pass", "pass"}));
  EXPECT_EQ(rows[2], (std::vector<std::string>{"ball", "–", "–", "pass"}));
}

TEST(Penetration, SeriesHaveOneRowAFrame) {
  const std::vector<RunRecord> runs = {desk_run("xpbd", "default", "none")};
  const auto csv = parse_csv(series_csv(set_ups(runs)));
  ASSERT_EQ(csv.size(), 3u);
  for (const auto& row : csv) ASSERT_EQ(row.size(), csv[0].size());
  EXPECT_EQ(csv[2][8], "0.0138889");
  EXPECT_EQ(csv[2][9], "0.0123");
  EXPECT_EQ(csv[2][10], "") << "NaN is missing";
  EXPECT_EQ(csv[2][11], "") << "so is a metric the scene does not have";
}

TEST(Penetration, JsonHasNullForMissing) {
  const std::vector<RunRecord> runs = {desk_run("xpbd", "default", "none")};
  const nlohmann::json j = nlohmann::json::parse(penetration_json(set_ups(runs)).dump());
  EXPECT_EQ(j.at(0).at("contact_length_max_m"), 0.0123);
  EXPECT_TRUE(j.at(0).at("depth_max_m").is_null());
  EXPECT_EQ(j.at(0).at("expect"), "pass");
}

TEST(RoomPair, DistanceIsMeasuredVertexByVertex) {
  std::vector<RunRecord> runs = {desk_run("paper", "default", "any_vertex_inside"),
                                 desk_run("paper", "whole-room", "none"),
                                 desk_run("xpbd", "default", "any_vertex_inside")};
  runs[1].accuracy.position[4] = 0.5f;   // first frame, second vertex
  runs[1].accuracy.position[8] = 0.25f;  // last frame, first vertex
  runs[1].summary["frame_wall_median_s"] = 0.012;
  runs[1].summary["stage_device_median_s.Mesh"] = 0.2;
  const std::vector<RunPair> pairs = run_pairs(runs, "whole-room");
  ASSERT_EQ(pairs.size(), 1u) << "xpbd has no other half";
  EXPECT_EQ(pairs[0].run, &runs[0]);
  EXPECT_EQ(pairs[0].other, &runs[1]);
  EXPECT_EQ(pairs[0].apart.end, 0.25);
  EXPECT_EQ(pairs[0].value, 0.5);
  const auto rows = parse_markdown(room_table(pairs).markdown());
  ASSERT_EQ(rows.size(), 4u);
  EXPECT_EQ(rows[0][3], "wall [ms]");
  EXPECT_EQ(rows[3][3], "3.00");
  EXPECT_EQ(rows[3][5], "100") << "of the stages that serve static meshes";
  EXPECT_NE(room_table(pairs).note.find("0.25 m at the end, 0.5 m over all frames"), std::string::npos)
      << room_table(pairs).note;
}

TEST(RoomPair, WhatDiffersOtherwiseOrIsNotMeasuredIsNotCompared) {
  std::vector<RunRecord> runs = {desk_run("paper", "default", "any_vertex_inside"),
                                 desk_run("paper", "whole-room", "none")};
  runs[1].accuracy.position.pop_back();
  EXPECT_TRUE(std::isnan(run_pairs(runs, "whole-room").at(0).apart.end)) << "trajectories of different lengths";
  EXPECT_NE(room_table(run_pairs(runs, "whole-room")).note.find("not measured"), std::string::npos);
  runs[1] = desk_run("paper", "whole-room", "none");
  runs[1].accuracy.position[0] = NAN;
  EXPECT_TRUE(std::isnan(run_pairs(runs, "whole-room").at(0).value));
  runs[1] = desk_run("paper", "whole-room", "none");
  runs[1].header.settings["iterations"] = 7;
  EXPECT_TRUE(run_pairs(runs, "whole-room").empty());
  runs[1] = desk_run("paper", "whole-room", "none");
  const auto at = runs[1].header.scenario_json.find("double-duplicated");
  runs[1].header.scenario_json.replace(at, 17, "single");
  EXPECT_TRUE(run_pairs(runs, "whole-room").empty()) << "other sides";
}

TEST(Features, ComeFromTheResultFilesAlone) {
  std::vector<RunRecord> runs = {
      desk_run("paper", "default", "none"),
      with_outcome(desk_run("absent", "default", "none"), "unsupported", -1, "not in this build"),
      desk_run("ignorant", "default", "none")};
  runs[1].header.environment.erase("solver_features");
  runs[2].header.environment["solver_features"] = {
      {"supports", {"plane", "antigravity"}}, {"ignores", {"sphere"}}, {"only_with", {{"plane"}}}};
  runs[2].header.stages.clear();
  const Table t = feature_table(solver_features(runs), true);
  const auto text = [&](const std::string& feature, std::size_t column) {
    for (const auto& row : t.rows)
      if (row[0] == feature) return row.at(column);
    return std::string("no row");
  };
  EXPECT_EQ(t.rows.at(0), (std::vector<std::string>{"feature", "paper", "absent", "ignorant"}));
  EXPECT_EQ(t.rows.size(), kFeatureCount + 1);
  EXPECT_EQ(text("static mesh", 1), "yes (only with duplicated layer)");
  EXPECT_EQ(text("friction", 1), "yes");
  EXPECT_EQ(text("sphere", 1), "declared") << "no run shows it";
  EXPECT_EQ(text("plane", 1), "no");
  EXPECT_EQ(text("plane", 2), "not built");
  EXPECT_EQ(text("sphere", 3), "ignored");
  EXPECT_EQ(text("plane", 3), "declared");
  runs[0].outcome.status = "diverged";
  EXPECT_EQ(feature_text(solver_features(runs).at(0), Feature::Friction, true), "declared")
      << "a run that failed shows nothing";
  EXPECT_EQ(feature_json(solver_features(runs), true)
                .at(static_cast<std::size_t>(Feature::Sphere))
                .at("solvers")
                .at("ignorant"),
            "ignored");
}

TEST(Penetration, TablesSayWhereTheSolverHoldsTheCloth) {
  const std::string scenario = R"({"cloth":{"grid":[8,8]},"colliders":[{"type":"box","margin_m":0.004}]})";
  std::vector<RunRecord> runs = {of_scene(desk_run("xpbd", "default", ""), "box", scenario),
                                 of_scene(desk_run("other", "default", ""), "box", scenario),
                                 of_scene(desk_run("none", "default", ""), "box", scenario)};
  runs[1].header.plan["contact_margins"] = {{{"collider", "named otherwise"}, {"margin_m", 0.02}}};
  runs[2].outcome.status = "unsupported";
  EXPECT_EQ(held_at(runs[0]), "4") << "the scene's margin";
  EXPECT_EQ(held_at(runs[1]), "20") << "what the solver states";
  EXPECT_EQ(held_at(runs[2]), "–");
  runs[1].header.plan["contact_margins"].push_back({{"collider", "box"}, {"margin_m", 0.0035}});
  EXPECT_EQ(held_at(runs[1]), "3.5 to 20");
  const std::vector<ContactSetUp> ups = set_ups(runs);
  const Table verdicts = verdict_table(ups);
  EXPECT_EQ(verdicts.rows.at(0), (std::vector<std::string>{"scene", "none", "other", "xpbd"}));
  EXPECT_EQ(verdicts.rows.at(1),
            (std::vector<std::string>{"(the solver holds the cloth at [mm])", "–", "3.5 to 20", "4"}));
  const Table t = contact_table(ups.at(0));
  EXPECT_EQ(t.rows.at(0).at(3), "holds at [mm]");
  EXPECT_EQ(t.rows.at(2).at(3), "3.5 to 20");
  EXPECT_EQ(penetration_json(ups).at(1).at("held_at_most_m"), 0.02);
}

}  // namespace
}  // namespace clothbench

#include "scenario/study.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <nlohmann/json.hpp>
#include <set>

#include "base/json_text.hpp"
#include "clothbench/solver.hpp"
#include "scenario/load.hpp"
#include "scratch_folder.hpp"

namespace clothbench {
namespace {

TEST(Study, FaultsNameFileAndPointer) {
  const auto fault = [](const std::string& from, const std::string& to) {
    std::string text = replaced(read_text(scenario_root() / "studies/table3.json"), from, to);
    const auto gravity = text.find("../paper/gravity.json");
    if (gravity != std::string::npos) text.replace(gravity, 21, CLOTHBENCH_SOURCE_DIR "/scenarios/paper/gravity.json");
    const ScratchFolder folder;
    return refusal([&] { load_study(folder.file("study.json", text)); });
  };
  EXPECT_EQ(fault("\"trials\": 5", "\"trials\": 6"), "");
  EXPECT_PRED2(mentions, fault("\"trials\": 5", "\"trials\": 0"), "/trials");
  EXPECT_PRED2(mentions, fault("\"drop_frames\"", "\"dropframes\""), "nearest known: drop_frames");
  EXPECT_PRED2(mentions, fault("\"labels\": [\"8\", ", "\"labels\": ["), "/scenes/0/axes/0/labels");
  EXPECT_PRED2(mentions, fault("[8, 8]", "[0, 8]"), "/cloth/grid/0");
  EXPECT_PRED2(mentions, fault("../paper/gravity.json", "nowhere.json"), "nowhere.json");
}

/// A study of two scenes, the first in two sizes, with `more` after its solvers.
std::string study_text(const std::string& solvers, const std::string& more = "", const std::string& protocol = "fps") {
  const std::string root = CLOTHBENCH_SOURCE_DIR "/scenarios/";
  return R"({"name":"s","why":"A test.","protocol":")" + protocol + R"(","scenes":[
    {"file":")" +
         root + R"(paper/gravity.json","tags":["free"],
     "axes":[{"key":"cloth.grid","values":[[8,8],[9,7]],"labels":["8","9x7"]}]},
    {"file":")" +
         root + R"(contact/sphere.json","tags":["shape"]}],
    "solvers":)" +
         solvers + R"(,"trials":5,
    "rules":{"frames":72,"max_wall_s":2,"min_frames":12,"warmup_s":0.1})" +
         more + "}";
}

Study study_of(const std::string& text, StudyOptions options = {}) {
  const ScratchFolder folder;
  return load_study(folder.file("s.json", text), options);
}

std::string study_error(const std::string& text, StudyOptions options = {}) {
  return refusal([&] { study_of(text, options); });
}

/// Names of solvers and scenes, with the sides of the cloth in each run.
std::vector<std::string> runs(const Study& s) {
  std::vector<std::string> out;
  for (const Study::Item& item : s.scenes)
    for (const std::size_t k : item.solvers)
      out.push_back(item.scene.name + " " + s.solvers[k].name() +
                    (item.scene.cloth.sides == Sides::DoubleDuplicated ? " duplicated" : ""));
  return out;
}

TEST(Study, SolversChangeScenesForThemselvesAlone) {
  const Study s = study_of(study_text(
      R"([{"solver":"a","tags":["shape"],"set":{"cloth.sides":"double-duplicated","colliders.0.radius_m":0.2}},
                                          {"solver":"b"},{"solver":"a","label":"x","tags":["9x7","shape"]}])",
      "", "penetration"));
  EXPECT_EQ(runs(s), (std::vector<std::string>{"gravity-8 b", "gravity-9x7 b", "gravity-9x7 a x",
                                               "sphere-drop a duplicated", "sphere-drop b", "sphere-drop a x"}));
  const Scene& changed = s.scenes[2].scene;
  EXPECT_EQ(changed.colliders.at(0).radius_m, 0.2);
  EXPECT_TRUE(changed.needs.has(Feature::DuplicatedLayer));
  EXPECT_PRED2(mentions, changed.json, "double-duplicated") << "what is stored is what runs";
  EXPECT_NE(changed.sha256, s.scenes[3].scene.sha256);
  EXPECT_EQ(s.scenes[2].group, s.scenes[3].group) << "all forms of a scene are timed in turns";
  EXPECT_NE(s.scenes[1].group, s.scenes[2].group);
}

TEST(Study, AnAxisMayChangeOtherKeysAlong) {
  const auto with = [](const std::string& more) {
    return replaced(study_text(R"([{"solver":"a"}])"), R"("9x7"]})", R"("9x7"],"with":)" + more + "}");
  };
  const Study s = study_of(with(R"({"time.duration_s":[0.25,0.5]})"));
  EXPECT_EQ(s.scenes[0].scene.time.duration_s, 0.25);
  EXPECT_EQ(s.scenes[1].scene.time.duration_s, 0.5);
  EXPECT_PRED2(mentions, study_error(with(R"({"time.duration_s":[0.25]})")),
               "/scenes/0/axes/0/with/time.duration_s: expected one per value of the axis, 2; found 1");
}

TEST(Study, AKeyOfAnAxisIsNotOverridden) {
  EXPECT_PRED2(mentions, study_error(study_text(R"([{"solver":"a"}])"), {{"cloth.grid=[4,4]"}}),
               "--set cloth.grid=[4,4]: the study");
}

TEST(Study, AccuracyPassOfPenetrationIsTheWholeScene) {
  EXPECT_TRUE(std::isinf(study_of(study_text(R"([{"solver":"a"}])", "", "penetration")).accuracy_duration_s));
  EXPECT_EQ(study_of(study_text(R"([{"solver":"a"}])")).accuracy_duration_s, 0.5);
  EXPECT_EQ(study_of(study_text(R"([{"solver":"a"}])", R"(,"accuracy_duration_s":2)")).accuracy_duration_s, 2);
}

TEST(Study, QuickLeavesOutAndShortens) {
  const std::string solvers = R"([{"solver":"a"},{"solver":"a","label":"x"},{"solver":"b"}])";
  const std::string text = study_text(solvers, R"(,"quick":{"tags":{"a x":["8","sphere-drop"],"b":["8"]},"trials":2,
    "rules":{"frames":5,"max_wall_s":0,"min_frames":5,"warmup_s":0}})");
  const Study quick = study_of(text, {{}, StudyLength::Quick});
  EXPECT_EQ(runs(quick), (std::vector<std::string>{"gravity-8 a x", "gravity-8 b", "sphere-drop a x"}));
  EXPECT_EQ(quick.trials, 2);
  EXPECT_EQ(quick.rules.frames, 5);
  const Study whole = study_of(text);
  EXPECT_EQ(runs(whole).size(), 9u);
  EXPECT_EQ(whole.trials, 5);
  EXPECT_EQ(whole.rules.frames, 72);
  EXPECT_EQ(study_of(study_text(solvers, R"(,"quick":{"tags":[]})"), {{}, StudyLength::Quick}).rules.frames, 72)
      << "rules of the study where quick has none";
  EXPECT_PRED2(mentions, study_error(study_text(solvers), {{}, StudyLength::Quick}), "\"quick\" is missing");
}

TEST(Study, SolversAskedForAloneOrJoined) {
  const std::string text =
      study_text(R"([{"solver":"a"},{"solver":"a","label":"x","set":{"cloth.sides":"double"}},{"solver":"b"}])",
                 R"(,"quick":{"tags":{"a":["8"]},"rules":{"frames":5,"max_wall_s":0,"min_frames":5,"warmup_s":0}})");
  const auto asked = [&](StudyLength length, std::vector<std::string> solvers) {
    const Study s = study_of(text, {{}, length, Assets::MayBeProcedural, std::move(solvers)});
    EXPECT_EQ(s.solvers.size(), 4u);
    EXPECT_TRUE(s.solvers.back().joined);
    std::vector<std::string> gravity8;
    for (const std::string& c : runs(s))
      if (c.starts_with("gravity-8 ")) gravity8.push_back(c.substr(10));
    return gravity8;
  };
  EXPECT_EQ(asked(StudyLength::Full, {"mine", "a"}), (std::vector<std::string>{"a", "mine", "a x"}));
  EXPECT_EQ(asked(StudyLength::Quick, {"mine", "a"}), (std::vector<std::string>{"a", "mine"}));
  EXPECT_EQ(asked(StudyLength::Quick, {"b", "mine"}), (std::vector<std::string>{"b", "mine"})) << "asked for by name";
}

TEST(Study, WordsThatChooseNothingAreFaults) {
  const auto quick = [](const std::string& inside) {
    return study_text(R"([{"solver":"a"}])",
                      R"(,"quick":{"rules":{"frames":5,"max_wall_s":0,"min_frames":5,"warmup_s":0},)" + inside + "}");
  };
  EXPECT_EQ(study_error(quick(R"("tags":["shape"])")), "");
  for (const auto& [text, fault] :
       {std::pair{quick(R"("tags":["shapes"])"), "/quick/tags/0: \"shapes\" is unknown; nearest known: shape"},
        {quick(R"("tags":{"a x":["shape"]})"), "/quick/tags: \"a x\" is unknown"},
        {study_text(R"([{"solver":"a","tags":["shape","fre"]}])"), "/solvers/0/tags/1"},
        {study_text(R"([{"solver":"a"},{"solver":"a"}])"), "two runs are named"},
        {study_text(R"([{"solver":"a","set":{"cloth.side":"double"}}])"), "nearest known: sides"},
        {study_text(R"([{"solver":"a","tags":["shape"],"set":{"colliders.1.friction":0}}])"),
         "/colliders/1: expected an item"},
        {study_text(R"([{"solver":"a","tags":["shape"],"set":{"colliders.x.friction":0}}])"), "/colliders/x"}})
    EXPECT_PRED2(mentions, study_error(text), fault);
}

TEST(Study, PenetrationHasEveryCombinationItNames) {
  const Study s = load_study("penetration");
  std::set<std::string> scenes;
  for (const Study::Item& item : s.scenes) {
    scenes.insert(item.scene.name);
    EXPECT_FALSE(item.scene.colliders.empty() && item.scene.grips.vertices.empty())
        << item.scene.name << " touches nothing";
    for (const std::size_t k : item.solvers)
      if (s.solvers[k].solver == "paper") {
        // It does not support two-sided contact without a second layer.
        EXPECT_EQ(item.scene.cloth.sides == Sides::Double, item.scene.colliders.empty()) << item.scene.name;
        EXPECT_FALSE(item.scene.needs.has(Feature::SelfCollision)) << item.scene.name << ": it passes through itself";
      }
  }
  EXPECT_TRUE(scenes.contains("self-fold") && scenes.contains("self-crumple"));
  EXPECT_EQ(scenes.size(), 18u);
}

TEST(Settings, AreCompletedAndChecked) {
  SolverInfo info;
  info.name = "s";
  info.settings = {{"iterations", "5", ""}, {"stiffness", "0.8", ""}, {"mode", "\"a\"", ""}};
  EXPECT_EQ(complete_settings(info, {{"iterations", 7}})["iterations"], 7);
  EXPECT_EQ(complete_settings(info, {{"stiffness", 1}})["stiffness"], 1) << "an integer is a number";
  const auto fault = [&](const nlohmann::json& given) { return refusal([&] { complete_settings(info, given); }); };
  EXPECT_PRED2(mentions, fault({{"iteration", 7}}), "nearest known: iterations");
  EXPECT_PRED2(mentions, fault({{"iterations", 7.5}}), "expected an integer");
  EXPECT_PRED2(mentions, fault({{"mode", true}}), "expected a string");
}

TEST(Settings, TuningIsOneObject) {
  SolverInfo info;
  info.name = "tuned";
  info.settings = {{"iterations", "5", ""}};
  info.tuning = {{"lanes", "0", ""}, {"shuffles", "true", ""}};
  const nlohmann::json defaults = {{"iterations", 5}, {"tuning", {{"lanes", 0}, {"shuffles", true}}}};
  const nlohmann::json given = {{"tuning", {{"shuffles", false}}}};
  EXPECT_EQ(complete_settings(info, nlohmann::json::object()), defaults);
  EXPECT_EQ(complete_settings(info, given)["tuning"], (nlohmann::json{{"lanes", 0}, {"shuffles", false}}));
  for (const nlohmann::json& bad : {nlohmann::json{{"tuning", {{"shufles", true}}}},
                                    {{"tuning", {{"iterations", 5}}}},
                                    {{"tuning", 3}},
                                    {{"tuning", {{"lanes", true}}}},
                                    {{"shuffles", true}}})
    EXPECT_THROW(complete_settings(info, bad), Error) << bad;
  info.tuning.clear();
  EXPECT_THROW(complete_settings(info, given), Error) << "another solver has none";
}

}  // namespace
}  // namespace clothbench

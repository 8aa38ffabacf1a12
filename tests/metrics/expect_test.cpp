#include <gtest/gtest.h>

#include <cmath>

#include "clothbench/solver.hpp"
#include "refusal.hpp"
#include "runner/solver_run.hpp"
#include "runner/study_runner.hpp"
#include "scenario/load.hpp"

namespace clothbench {
namespace {

Scene scene_expecting(const std::string& expect) {
  return load_scene("paper/gravity", {"cloth.grid=[3,3]", "time.duration_s=1", "expect=" + expect});
}

AccuracyPass whole_pass(const Scene& scene) {
  AccuracyPass pass;
  for (int f = 0; f <= scene.time.frames(); ++f) pass.time_s.push_back(f * scene.time.dt());
  return pass;
}

Judgement verdict(const std::string& expect, const std::map<std::string, double>& summary,
                  const std::string& status = "ok") {
  const Scene scene = scene_expecting(expect);
  Outcome outcome;
  outcome.status = status;
  return judge(scene, outcome, whole_pass(scene), summary);
}

TEST(Expect, BoundsIncludeTheirEnds) {
  const char* bounds = R"({"stretch_max":{"at_least":0.1,"at_most":0.2}})";
  for (double v : {0.1, 0.15, 0.2}) EXPECT_EQ(verdict(bounds, {{"stretch_max", v}}).text, "pass") << v;
  EXPECT_EQ(verdict(bounds, {{"stretch_max", 0.21}}).text, "fail: stretch_max 0.21 > 0.2");
  EXPECT_EQ(verdict(bounds, {{"stretch_max", 0.09}}).text, "fail: stretch_max 0.09 < 0.1");
}

TEST(Expect, NoValueBreaks) {
  const char* bounds = R"({"stretch_max":{"at_most":0.2}})";
  for (const auto& summary :
       {std::map<std::string, double>{}, {{"stretch_max", kMissing}}, {{"stretch_max", -INFINITY}}}) {
    const Judgement v = verdict(bounds, summary);
    EXPECT_EQ(v.text, "fail: stretch_max has no value");
    EXPECT_EQ(v.scalars.at("expect.stretch_max"), 0);
  }
}

TEST(Expect, OutcomesAreCompared) {
  EXPECT_EQ(verdict(R"({"outcome":"ok"})", {}, "timed_out").text, "fail: outcome timed_out, expected ok");
  EXPECT_EQ(verdict(R"({"outcome":"not_finite"})", {}, "not_finite").text, "pass")
      << "a scene may be meant to break solvers";
  EXPECT_EQ(verdict(R"({"outcome":"ok"})", {}, "unsupported").text, "not measured");
  EXPECT_EQ(verdict("{}", {}).text, "");
}

TEST(Expect, AFailureBeforeTheEndIsMeasuredAShortPassIsNot) {
  const Scene scene = scene_expecting(R"({"outcome":"ok"})");
  AccuracyPass pass;
  pass.time_s = {0, 1 / 72.0};
  Outcome outcome;
  EXPECT_EQ(judge(scene, outcome, pass, {}).text, "not measured");
  outcome.status = "diverged";
  EXPECT_EQ(judge(scene, outcome, pass, {}).text, "fail: outcome diverged, expected ok");
}

TEST(Expect, MistakesAreRefusedWithTheNearestName) {
  const auto message = [](const std::string& expect) { return refusal([&] { scene_expecting(expect); }); };
  EXPECT_PRED2(mentions, message(R"({"crossing_max":{"at_most":0}})"), "nearest known: crossings_max");
  EXPECT_PRED2(mentions, message(R"({"stretch_max":{"atmost":0}})"), "nearest known: at_most");
  EXPECT_PRED2(mentions, message(R"({"stretch_max":{}})"), "/expect/stretch_max");
  EXPECT_PRED2(mentions, message(R"({"stretch_max":{"at_most":1,"at_least":2}})"),
               "expected at_least below or equal to at_most");
  EXPECT_PRED2(mentions, message(R"({"outcome":"fine"})"), "/expect/outcome");
  EXPECT_EQ(message(R"({"stretch_max":{"at_most":1}})"), "");
}

// Each name that the schema allows in `expect` must be in the summary; otherwise it could never have a value.
TEST(Expect, EveryNameTheSchemaKnowsIsInTheSummary) {
  const Scene scene = scene_expecting("{}");
  const SolverEntry& entry = find_solver("ballistic");
  const auto summary = summarise({&scene, &entry, nlohmann::json::object()}, {}, {});
  const nlohmann::json schema = nlohmann::json::parse(kSceneSchema);
  for (const auto& [name, unused] : schema["properties"]["expect"]["properties"].items()) {
    if (name == "outcome" || name == "contact") continue;
    EXPECT_TRUE(summary.contains(name)) << name;
  }
}

}  // namespace
}  // namespace clothbench

// Study `reproduction`: points that fill the box of what the article leaves open, shared by the claims of a round.
#include <gtest/gtest.h>

#include <cmath>
#include <map>
#include <set>

#include "base/json_text.hpp"
#include "clothbench/error.hpp"
#include "refusal.hpp"
#include "scenario/draw_contact.hpp"
#include "scenario/load.hpp"
#include "scenario/study.hpp"

namespace clothbench {
namespace {

using nlohmann::json;

constexpr std::uint64_t kClaims = 2;

ContactKind kind(const json& settings, const json& own = {{"colliders.0.margin_m", {0.001, 0.02}}}) {
  const json base = parse_json(read_text(find_scenario("paper/capsule-sweep")), "capsule-sweep");
  return {"sweep",
          "box",
          base,
          own,
          "mine.json: /scenes/0/draw",
          {{"settings", {{"paper", settings}}}, {"ranges", {{"material.damping_per_s", {0, 2}}}}},
          kClaims};
}

const json kSettings = {{"iterations", {1, 100}}, {"stiffness", {0.1, 1}}, {"collisions", {"after", "inside"}}};

TEST(DrawBox, AllClaimsOfARoundShareTheSettings) {
  ContactDrawer drawer(Assets::MayBeProcedural);
  ContactKind other = kind(kSettings, json::object());
  other.name = "other";
  for (std::uint64_t round = 1; round < 20; ++round) {
    const json a = drawer.draw(kind(kSettings), "mine", kClaims * round + 1),
               b = drawer.draw(other, "mine", kClaims * round + 2);
    EXPECT_EQ(a["drawn"]["settings"], b["drawn"]["settings"]);
    EXPECT_EQ(a["material"]["damping_per_s"], b["material"]["damping_per_s"]);
    EXPECT_NE(a["drawn"]["settings"], drawer.draw(other, "mine", kClaims * (round + 20) + 1)["drawn"]["settings"]);
  }
}

TEST(DrawBox, PointsFillTheBoxEvenlyAndReachItsCorners) {
  constexpr int kRounds = 256, kParts = 4;
  ContactDrawer drawer(Assets::MayBeProcedural);
  std::map<std::string, std::array<int, kParts>> counts;
  int corners = 0;
  for (std::uint64_t round = 0; round < kRounds; ++round) {
    const json scene = drawer.draw(kind(kSettings), "mine", kClaims * round + 1);
    const json& settings = scene["drawn"]["settings"]["paper"];
    ASSERT_TRUE(settings["iterations"].is_number_integer());
    const double iterations = settings["iterations"], stiffness = settings["stiffness"];
    ASSERT_TRUE(iterations >= 1 && iterations <= 100 && stiffness >= 0.1 && stiffness <= 1) << scene["drawn"];
    corners += (iterations == 1 || iterations == 100) && (stiffness == 0.1 || stiffness == 1);
    const auto part = [&](const std::string& name, double u) {
      ++counts[name].at(static_cast<std::size_t>(std::clamp(static_cast<int>(kParts * u), 0, kParts - 1)));
    };
    // Ranges that span a decade are even in the logarithm.
    part("iterations", std::log(iterations) / std::log(100));
    part("stiffness", std::log10(stiffness / 0.1));
    part("words", settings["collisions"] == "after" ? 0.25 : 0.75);
    part("damping", scene["material"]["damping_per_s"].get<double>() / 2);
    part("margin", std::log(scene["colliders"][0]["margin_m"].get<double>() / 0.001) / std::log(20));
  }
  for (const auto& [name, in] : counts) {
    if (name == "words") continue;
    for (const int n : in) EXPECT_NEAR(n, kRounds / kParts, kRounds / 12) << name;
  }
  EXPECT_NEAR(counts["words"][1], kRounds / 2, kRounds / 12);
  EXPECT_NEAR(corners, 0.1 * kRounds, 0.06 * kRounds);
}

TEST(DrawBox, RefusesRangesThatAreNone) {
  ContactDrawer drawer(Assets::MayBeProcedural);
  for (const auto& [range, words] : {std::pair{json{2, 1}, "iterations: expected the lower bound first"},
                                     {json{1, "a"}, "iterations: expected a list of words, or two numbers"},
                                     {json{1, 2, 3}, "iterations: expected a list of words, or two numbers"}}) {
    const ContactKind wrong = kind({{"iterations", range}});
    EXPECT_PRED2(mentions, refusal([&] { drawer.draw(wrong, "mine", 1); }), words) << range;
  }
}

TEST(DrawBox, RefusesAStudyWithoutABox) {
  ContactKind none = kind(kSettings);
  for (const json& box : {json(), json::object(), json{{"settings", json::object()}}}) {
    none.box = box;
    EXPECT_THROW(ContactDrawer(Assets::MayBeProcedural).draw(none, "mine", 1), Error) << box;
  }
}

TEST(DrawBox, QuickFormRunsAllClaimsAtEachPointInAMinute) {
  std::map<std::string, std::set<std::string>> claims;
  double work = 0;
  for (const Study::Item& item : load_study("reproduction", {{}, StudyLength::Quick}).scenes) {
    const json settings = item.drawn_settings["paper"];
    claims[settings.dump()].insert(json::parse(item.scene.json)["drawn"]["kind"]);
    work += static_cast<double>(item.scene.cloth.vertex_count()) * item.scene.time.frames() *
            settings["iterations"].get<double>() * settings["substeps"].get<double>();
  }
  EXPECT_EQ(claims.size(), 2u);
  for (const auto& [settings, kinds] : claims) EXPECT_EQ(kinds.size(), 6u) << settings;
  // 1.1e7 vertices × iterations take 40 s on a software device with two cores.
  EXPECT_LE(work, 1.2e7);
}

/// Settings of `paper` that the article leaves open and that a scene uses.
std::set<std::string> open_settings(const Scene& s) {
  std::set<std::string> out = {"iterations", "substeps", "stiffness", "relaxation"};
  if (s.colliders.empty()) return out;
  out.insert({"collisions", "projection", "friction_on"});
  for (const Collider& c : s.colliders) {
    if (c.shape != Collider::Shape::Mesh) continue;
    out.insert({c.moves() ? "hand_depth_m" : "mesh_depth_m", "second_layer"});
  }
  return out;
}

TEST(PaperScenes, ListTheSettingsThatTheArticleLeavesOpen) {
  for (const auto& file : std::filesystem::directory_iterator(scenario_root() / "paper")) {
    const Scene s = load_scene(file.path().string());
    std::set<std::string> listed;
    const json given = parse_json(read_text(file.path()), file.path().string());
    for (const json& entry : given["assumed"])
      if (const auto text = entry.get<std::string>(); text.starts_with("solver:paper."))
        listed.insert(text.substr(std::string("solver:paper.").size()));
    EXPECT_EQ(listed, open_settings(s)) << file.path();
  }
}

}  // namespace
}  // namespace clothbench

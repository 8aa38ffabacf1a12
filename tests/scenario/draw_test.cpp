// Random scenes of study `contact`: equal for equal seeds, different for others, all within their ranges and loadable.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <map>
#include <set>
#include <thread>

#include "assets/assets.hpp"
#include "base/files.hpp"
#include "base/json_text.hpp"
#include "clothbench/error.hpp"
#include "clothbench/solver.hpp"
#include "refusal.hpp"
#include "scenario/draw_contact.hpp"
#include "scenario/load.hpp"
#include "scenario/study.hpp"

namespace clothbench {
namespace {

using nlohmann::json;

constexpr int kKinds = 10;

/// One form of each scene: the one that `bullet-soft` runs.
Study drawn(std::uint64_t seed, int count, StudyLength length = StudyLength::Full) {
  StudyOptions o;
  o.length = length;
  o.solvers = {"bullet-soft"};
  o.seed = seed;
  o.count = count;
  return load_study("contact", o);
}

std::string all_json(const Study& s) {
  std::string out;
  for (const Study::Item& item : s.scenes) out += item.scene.json + "\n";
  return out;
}

TEST(DrawContact, IsTheSameForASeedHoweverManyThreadsDraw) {
  const std::string once = all_json(drawn(17, kKinds));
  std::vector<std::string> others(2);
  std::vector<std::thread> threads;
  for (std::string& other : others) threads.emplace_back([&other] { other = all_json(drawn(17, kKinds)); });
  for (std::thread& t : threads) t.join();
  for (const std::string& other : others) EXPECT_EQ(other, once);
  // A scene depends only on its own seed.
  const Study some = drawn(19, 1);
  EXPECT_EQ(some.scenes[0].scene.json, drawn(17, kKinds).scenes[2].scene.json);
  std::set<std::string> different;
  for (const Study::Item& item : drawn(1, 2 * kKinds).scenes) different.insert(item.scene.sha256);
  EXPECT_EQ(different.size(), 2u * kKinds);
}

TEST(DrawContact, AllScenesOf200SeedsLoadAndLoadAgain) {
  const Study study = drawn(1, 200);
  ASSERT_EQ(study.scenes.size(), 200u);
  for (const Study::Item& item : study.scenes) {
    const json scene = json::parse(item.scene.json);
    EXPECT_EQ(item.scene.name,
              "contact-" + std::to_string(*item.scene.seed) + "-" + scene["drawn"]["kind"].get<std::string>());
    EXPECT_GE(item.scene.expect.size(), 3u) << item.scene.name;
    if (*item.scene.seed > 2 * kKinds) continue;
    const Scene again = scene_from_json(scene, "again");
    EXPECT_EQ(again.sha256, item.scene.sha256) << item.scene.name;
  }
}

/// Scenes of the seeds from 1 on as generated, neither completed nor loaded, because that takes long.
std::vector<json> drawn_alone(std::uint64_t count) {
  const std::filesystem::path file = find_scenario("contact");
  const json study = drawn(1, 1).definition;
  std::vector<ContactKind> kinds;
  for (const json& item : study["scenes"])
    kinds.push_back(contact_kind(item, file.parent_path() / item["file"].get<std::string>(), "contact"));
  ContactDrawer drawer(Assets::MayBeProcedural);
  std::vector<json> out;
  for (std::uint64_t seed = 1; seed <= count; ++seed)
    out.push_back(drawer.draw(kinds[seed % kinds.size()], "contact", seed));
  return out;
}

/// Minimum and maximum of each random value, over kinds.
std::map<std::string, std::array<double, 2>> extremes(const std::vector<json>& scenes, const std::string& kind) {
  std::map<std::string, std::array<double, 2>> out;
  for (const json& scene : scenes) {
    const json& about = scene["drawn"];
    if (about["kind"] != kind) continue;
    for (const auto& [name, value] : about["values"].items()) {
      if (!value.is_number()) continue;
      auto& [low, high] = out.emplace(name, std::array<double, 2>{INFINITY, -INFINITY}).first->second;
      low = std::min(low, value.get<double>());
      high = std::max(high, value.get<double>());
    }
  }
  return out;
}

TEST(DrawContact, EveryRangeIsCoveredAndKept) {
  const std::vector<json> scenes = drawn_alone(40 * kKinds);
  const json study = drawn(1, 1).definition;
  for (const json& item : study["scenes"]) {
    const json& draw = item["draw"];
    const auto found = extremes(scenes, draw["kind"]);
    for (const auto& [name, range] : draw["ranges"].items()) {
      const double low = range[0], high = range[1];
      bool any = false;
      for (const auto& [drawn_name, is] : found) {
        // A range may be sampled several times, under different names.
        const bool its = drawn_name == name || (name == "depth_m" && drawn_name == "depth_in_m");
        if (!its) continue;
        any = true;
        EXPECT_GE(is[0], low - 1e-6) << draw["kind"] << " " << name;
        EXPECT_LE(is[1], high + 1e-6) << draw["kind"] << " " << name;
        const bool logarithmic = name == "speed_m_per_s" || name == "push_s";
        const double spread =
            logarithmic ? std::log(is[1] / is[0]) / std::log(high / low) : (is[1] - is[0]) / (high - low);
        EXPECT_TRUE(spread >= 0.8 || high == low) << draw["kind"] << " " << name;
      }
      const bool named_apart =
          name == "off_m" || name == "size_m" || (name == "above_middle_m" && draw["how"] == "stretch");
      EXPECT_TRUE(any || named_apart) << draw["kind"] << " " << name;
    }
  }
}

TEST(DrawContact, WordsAreCovered) {
  std::map<std::string, std::set<std::string>> words;
  for (const json& scene : drawn_alone(100 * kKinds))
    for (const auto& [name, value] : scene["drawn"]["values"].items())
      if (value.is_string()) words[name].insert(value.get<std::string>());
  EXPECT_EQ(words["hand"].size(), 2u);
  EXPECT_EQ(words["pose"].size(), assets::kPoseNames.size());
  if (!assets::locate_assets(false).npm) GTEST_SKIP() << "rooms have not been fetched";
  EXPECT_EQ(words["room"].size(), 5u);
  EXPECT_GE(words["table"].size(), 8u) << "any table of any room";
}

TEST(DrawContact, HandsComeFromAfarAndStayAwayForASecond) {
  for (const Study::Item& item : drawn(1, 3 * kKinds).scenes) {
    json as_capsules = json::parse(item.scene.json);
    if (as_capsules["colliders"].empty() || !as_capsules["colliders"][0].contains("track")) continue;
    as_capsules["colliders"][0]["type"] = "hand_capsules";
    const Scene s = scene_from_json(as_capsules, "as capsules");
    const auto nearest_to_cloth = [&](int frame) {  // the cloth hangs in z = 0
      double least = INFINITY;
      const ColliderPose& pose = s.motion[static_cast<std::size_t>(frame)].colliders[0];
      for (const Capsule& c : pose.capsules)
        least = std::min({least, std::abs(c.a_m[2]) - c.radius_m, std::abs(c.b_m[2]) - c.radius_m});
      return least;
    };
    EXPECT_GT(nearest_to_cloth(0), 0.05) << s.name;
    const int last = s.time.frames(), before = last - static_cast<int>(s.time.frame_rate_hz);
    EXPECT_GT(nearest_to_cloth(before + 1), 0.05) << s.name;
    EXPECT_EQ(s.time.frame_rate_hz,
              72 * std::max(1.0, std::ceil(json::parse(s.json)["drawn"]["speed_m_per_s"].get<double>() / 5)))
        << s.name;
  }
}

TEST(DrawContact, RecordedScenesStayAsTheyAre) {
  // Without desks, which depend on the available rooms.
  std::string all;
  for (const Study::Item& item : drawn(2, 8).scenes) {
    const json scene = json::parse(item.scene.json);
    all += scene["name"].dump() + scene["drawn"]["values"].dump() + scene["cloth"]["pose"].dump();
    for (const char* list : {"colliders", "grips"})
      for (const json& one : scene[list]) all += one.value("track", json()).dump();
  }
  EXPECT_EQ(sha256(all), "c2f593b42d26d37800261383029ce62a673ff861cf75ee59cd848be180c5c51b");
}

TEST(DrawContact, RefusesBadInput) {
  const json good = json::parse(read_text(find_scenario("contact")));
  const auto with = [&](const std::function<void(json&)>& change) {
    json j = good;
    for (json& item : j["scenes"])
      item["file"] = (scenario_root() / "studies" / item["file"].get<std::string>()).lexically_normal().string();
    change(j);
    const ScratchFolder folder;
    const auto file = folder.file("mine.json", j.dump());
    StudyOptions o;
    o.seed = 2;  // a sweep of capsules
    o.count = 1;
    return refusal([&] { load_study(file, o); });
  };
  const auto ranged = [&](const char* name, const json& range) {
    return with([&](json& j) { j["scenes"][2]["draw"]["ranges"][name] = range; });
  };
  EXPECT_EQ(with([](json&) {}), "");
  EXPECT_PRED2(mentions, with([](json& j) { j["scenes"][2]["draw"]["ranges"].erase("way_m"); }),
               "/scenes/2/draw/ranges: \"way_m\" is missing");
  EXPECT_PRED2(mentions, ranged("wy_m", {0, 1}),
               "/scenes/2/draw/ranges/wy_m: this range is not used; nearest known: way_m");
  EXPECT_PRED2(mentions, ranged("way_m", {1, 0}), "/scenes/2/draw/ranges/way_m: expected the lower bound first");
  EXPECT_PRED2(mentions, ranged("speed_m_per_s", {0, 1}), "expected a range above 0");
  EXPECT_PRED2(mentions, with([](json& j) { j["scenes"][2].erase("draw"); }), "/scenes/2: \"draw\" is missing");
  EXPECT_PRED2(mentions, with([](json& j) { j["protocol"] = "penetration"; }),
               "/scenes/0/draw: only for protocol contact");
}

// Study `reproduction`: points fill the box of settings that the article leaves open; the claims of a round share one.

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
    // Ranges that span a decade are uniform in the logarithm.
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

/// Settings `best` of the paper's solver are the point at which most claims hold; the report gives its seed.
TEST(DrawBox, TheBestOfThePaperIsAPointOfTheBox) {
  StudyOptions o;
  o.seed = 31;
  o.count = 1;
  const json point = load_study("reproduction", o).scenes.at(0).drawn_settings["paper"];
  for (const char* name : {"table3", "penetration", "work-precision"}) {
    int found = 0;
    for (const StudySolver& s : load_study(name).solvers) {
      if (s.label != "best") continue;
      ++found;
      for (const auto& [key, value] : s.settings.items()) EXPECT_EQ(value, point.value(key, json())) << name << key;
    }
    EXPECT_GT(found, 0) << name;
  }
}

TEST(DrawBox, CoordinatesBeyondTheSequenceDoNotFollowTheLast) {
  json settings = kSettings;
  for (int k = 0; k < 12; ++k) settings["other" + std::to_string(k)] = {0, 1};
  ContactDrawer drawer(Assets::MayBeProcedural);
  int opposite = 0;
  for (std::uint64_t round = 1; round <= 20; ++round) {
    const json scene = drawer.draw(kind(settings), "mine", kClaims * round + 1);
    const double last = scene["material"]["damping_per_s"], margin = scene["colliders"][0]["margin_m"];
    opposite += std::abs(last / 2 + std::log(margin / 0.001) / std::log(20) - 1) < 0.01;
  }
  EXPECT_LT(opposite, 5);
}

TEST(DrawBox, RefusesRangesThatAreNoneAndAStudyWithoutABox) {
  ContactDrawer drawer(Assets::MayBeProcedural);
  for (const auto& [range, words] : {std::pair{json{2, 1}, "iterations: expected the lower bound first"},
                                     {json{1, "a"}, "iterations: expected a list of words, or two numbers"},
                                     {json{1, 2, 3}, "iterations: expected a list of words, or two numbers"}}) {
    const ContactKind wrong = kind({{"iterations", range}});
    EXPECT_PRED2(mentions, refusal([&] { drawer.draw(wrong, "mine", 1); }), words) << range;
  }
  ContactKind none = kind(kSettings);
  for (const json& box : {json(), json::object(), json{{"settings", json::object()}}}) {
    none.box = box;
    EXPECT_THROW(drawer.draw(none, "mine", 1), Error) << box;
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
  std::set<std::string> known = {"readback", "stage_times", "count_bytes"};
  for (const auto& file : std::filesystem::directory_iterator(scenario_root() / "paper")) {
    const Scene s = load_scene(file.path().string());
    std::set<std::string> listed;
    const json given = parse_json(read_text(file.path()), file.path().string());
    for (const json& entry : given["assumed"])
      if (const auto text = entry.get<std::string>(); text.starts_with("solver:paper."))
        listed.insert(text.substr(std::string("solver:paper.").size()));
    EXPECT_EQ(listed, open_settings(s)) << file.path();
    known.merge(listed);
    json values = given;
    for (const char* key : {"/name", "/why", "/paper", "/expect", "/cloth/grid", "/cloth/sides", "/time/frame_rate_hz"})
      values[json::json_pointer(key)] = nullptr;  // stated by the article, or no property of the cloth
    for (const json& entry : given["assumed"])
      if (entry.get<std::string>()[0] == '/') values[json::json_pointer(entry.get<std::string>())] = nullptr;
    values.erase("assumed");
    const json left = values.flatten();
    for (const auto& [key, value] : left.items()) EXPECT_TRUE(value.is_null()) << file.path() << key;
  }
  for (const SolverEntry& s : solvers())
    for (const SettingSpec& x : s.info.settings)
      EXPECT_TRUE(s.info.name != "paper" || known.contains(x.name)) << x.name;
}

}  // namespace
}  // namespace clothbench

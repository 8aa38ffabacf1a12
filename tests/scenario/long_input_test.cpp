// Readers' messages about wrong input state the place briefly and do not repeat long input. Also tests messages about
// unknown radii in hand recordings, and about studies with too many runs.
#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

#include "assets/hand_track.hpp"
#include "assets/mesh_file.hpp"
#include "assets/room.hpp"
#include "base/json_text.hpp"
#include "base/words.hpp"
#include "scenario/cloth_mesh.hpp"
#include "scenario/load.hpp"
#include "scenario/study.hpp"

namespace clothbench {
namespace {

using nlohmann::json;

constexpr std::size_t kLong = 30000, kMostOfAMessage = 700;

const std::string kText(kLong, 'Q');

json scene() {
  json j = parse_json(read_text(find_scenario("contact/sphere")), "sphere.json");
  j["cloth"]["grid"] = {4, 4};
  j["pins"] = {{{"edge", "u0"}}};
  j["assumed"] = {"/material/membrane_stiffness_N_per_m"};
  return j;
}

json study(const std::string& scene_file) {
  return {{"name", "small"},
          {"why", "a study for the tests"},
          {"protocol", "fps"},
          {"trials", 1},
          {"drop_frames", 12},
          {"scenes",
           {{{"file", scene_file},
             {"axes", {{{"key", "cloth.grid"}, {"values", {{8, 8}, {9, 7}}}, {"labels", {"8", "9x7"}}}}}}}},
          {"solvers", {{{"solver", "ballistic"}, {"tags", {"8"}}}}},
          {"rules", {{"frames", 24}, {"max_wall_s", 1}, {"min_frames", 12}, {"warmup_s", 0.05}}}};
}

const json kRoom = {{"type", "scene"},
                    {"version", 1},
                    {"spatialEntities",
                     {{{"uuid", "a"},
                       {"semanticLabel_META", "TABLE"},
                       {"locatable_META", {{"orientation", {{"w", 1}}}, {"position", {{"x", 1}}}}},
                       {"bounded3D_META", {{"extent", {{"width", 1}, {"height", 1}, {"depth", 1}}}}}}}}};
const json kGltf = {{"asset", {{"version", "2.0"}}},
                    {"scene", 0},
                    {"scenes", {{{"nodes", {0}}}}},
                    {"nodes", {{{"name", "a"}, {"mesh", 0}}}},
                    {"meshes", {{{"primitives", {{{"attributes", {{"POSITION", 0}}}}}}}}},
                    {"extensionsRequired", {"KHR_materials_unlit"}}};

assets::HandRecording recording(float radius_m, bool capsules) {
  assets::HandRecording r{assets::Side::Left, 60, capsules, {{}, {}}};
  for (assets::RecordedHand& hand : r.frames) {
    for (assets::RecordedJoint& j : hand.joints) j.radius_m = 0.01f;
    for (assets::RecordedCapsule& c : hand.capsules) c.radius_m = 0.01f;
  }
  r.frames[1].joints[7].radius_m = radius_m;
  r.frames[1].capsules[3].radius_m = radius_m;
  return r;
}

/// Copies of the document: each of its values in turn replaced by a long string, and each key by a long one.
std::vector<json> lengthened(const json& document) {
  std::vector<json> out;
  const json flat = document.flatten();
  for (const auto& [pointer, unused] : flat.items()) {
    for (json::json_pointer at(pointer); !at.empty(); at.pop_back()) {
      out.push_back(document);
      out.back()[at] = kText;
      json& parent = (out.emplace_back(document))[at.parent_pointer()];
      if (!parent.is_object()) {
        out.pop_back();
        continue;
      }
      parent[kText] = parent[at.back()];
      parent.erase(at.back());
    }
  }
  return out;
}

template <class Read>
void expect_short(const char* reader, const json& document, Read read) {
  std::size_t refused = 0;
  for (const json& j : lengthened(document)) {
    const std::string why = refusal([&] { read(j.dump()); });
    refused += why.empty() ? 0 : 1;
    EXPECT_LE(why.size(), kMostOfAMessage) << reader << ": " << why.substr(0, kMostOfAMessage);
  }
  EXPECT_GT(refused, 3u) << reader;
}

TEST(LongInput, IsNotInTheMessage) {
  const ScratchFolder folder;
  const std::string file = folder.file("scene.json", scene().dump());
  EXPECT_EQ(refusal([&] { scene_from_json(scene(), "scene.json"); }), "");
  EXPECT_EQ(refusal([&] { load_study(folder.file("study.json", study(file).dump())); }), "");
  expect_short("scene", scene(), [](const std::string& t) { scene_from_json(parse_json(t, "s.json"), "s.json"); });
  expect_short("study", study(file), [&](const std::string& t) { load_study(folder.file("study.json", t)); });
  expect_short("track", parse_json(read_text(scenario_root() / "assets/left-hand-stretch-2mps.json"), "t.json"),
               [](const std::string& t) { assets::parse_hand_track(t, "t.json"); });
  expect_short("room", kRoom, [](const std::string& t) { assets::parse_room(t, "r.json", "r"); });
  expect_short("glTF", kGltf, [](const std::string& t) { assets::parse_gltf(t, "m.gltf"); });
  expect_short("recording", json::parse(assets::to_json(recording(0.01f, true), "a test")),
               [](const std::string& t) { assets::parse_hand_recording(t, "r.json"); });
}

TEST(LongInput, OfNoFormAtAllIsNotInTheMessage) {
  for (const std::string& text :
       {kText, "{\"" + kText, "{\"a\": " + kText, "[1, \"" + kText + "\n\"]", "{\"" + kText + "\": 1, }",
        "{\"" + kText + "\": 1, \"" + kText + "\": 2}", std::string(kLong, '1'), "\"; expected " + kText}) {
    const std::string why = refusal([&] { parse_json(text, "a.json"); });
    EXPECT_NE(why, "");
    EXPECT_LE(why.size(), 300u);
    EXPECT_EQ(why.find("a.json: "), 0u) << why;
    EXPECT_EQ(why.find("QQQQQ", why.find("QQQQQ") + 130), std::string::npos) << why;
  }
  for (const std::string& line :
       {"v 0 0 " + kText, "f 1 2 " + kText, "f 1 2 " + std::string(kLong, '1'), "v " + kText}) {
    const std::string why = refusal([&] { read_obj("v 0 0 0\n" + line + "\n", "m.obj"); });
    EXPECT_EQ(why.find("m.obj: line 2: "), 0u) << why.substr(0, 200);
    EXPECT_LE(why.size(), 200u);
  }
  EXPECT_LE(refusal([&] { load_scene(kText); }).size(), kMostOfAMessage);
  EXPECT_LE(refusal([&] { scene_from_json(scene(), "s.json", {"cloth." + kText + "=1"}); }).size(), kMostOfAMessage);
}

TEST(LongInput, QuotesAreShortAndWhole) {
  EXPECT_EQ(in_quotes("nan"), "\"nan\"");
  EXPECT_EQ(in_quotes(std::string("a\nb\x1b[31m\0", 9)), "\"a?b?[31m?\"");
  EXPECT_EQ(in_quotes(std::string(40, 'a')), "\"" + std::string(40, 'a') + "\"");
  EXPECT_EQ(in_quotes(std::string(41, 'a')), "\"" + std::string(40, 'a') + "…\"");
  EXPECT_EQ(shortened("aä", 2), "a…") << "no half of a character";
  EXPECT_EQ(shortened("aä", 3), "aä");
}

TEST(LongInput, ANameFitsIntoTheNamesOfFiles) {
  json j = scene();
  j["name"] = std::string(100, 'a');
  EXPECT_EQ(refusal([&] { scene_from_json(j, "s.json"); }), "");
  j["name"] = std::string(101, 'a');
  EXPECT_EQ(refusal([&] { scene_from_json(j, "s.json"); }).find("s.json: /name: 101 characters; expected at most 100"),
            0u);
  j["name"] = std::string(1000000, 'a');
  EXPECT_EQ(refusal([&] { scene_from_json(j, "s.json"); }),
            "s.json: /name: a string of 1000000 bytes; expected at most 4096");
}

TEST(ManyRuns, AreRefusedBeforeAnyIsMade) {
  const ScratchFolder folder;
  json j = study(folder.file("scene.json", scene().dump()));
  j["solvers"][0].erase("tags");
  json values = json::array(), labels = json::array();
  for (int k = 0; k < 1000; ++k) {
    values.push_back(0.1 + k);
    labels.push_back("a" + std::to_string(k));
  }
  j["scenes"][0]["axes"] = json::array();
  for (const char* key : {"material.damping_per_s", "cloth.areal_density_kg_per_m2", "time.duration_s"})
    j["scenes"][0]["axes"].push_back({{"key", key}, {"values", values}, {"labels", labels}});
  const std::string why = refusal([&] { load_study(folder.file("study.json", j.dump())); });
  EXPECT_PRED2(mentions, why,
               "study.json: /scenes/0/axes: they make 1000000000 scenes; a study may have at most 100000 runs");
}

TEST(Recording, ZeroRadiiOfCapsulesAreNamed) {
  const ScratchFolder folder;
  json j = scene();
  j["time"]["frame_rate_hz"] = 60;
  const auto why = [&](const char* type, float radius_m, bool capsules) {
    folder.file("hand.json", assets::to_json(recording(radius_m, capsules), "a test"));
    j["colliders"] = {{{"type", type}, {"track", "hand.json"}, {"friction", 0.3}}};
    return refusal([&] { load_scene(folder.file("scene.json", j.dump())); });
  };
  EXPECT_EQ(why("hand_capsules", 0.01f, true), "");
  EXPECT_EQ(why("hand_capsules", 0.01f, false), "");
  EXPECT_EQ(why("hand_mesh", 0, false), "") << "a mesh has no use for radii";
  EXPECT_PRED2(mentions, why("hand_capsules", 0, true),
               "hand.json: /recording/capsules: frame 1: capsule 3 of 19 has a radius");
  EXPECT_PRED2(mentions, why("hand_capsules", 0, false), "hand.json: /recording/joints: frame 1: capsule ");
}

}  // namespace
}  // namespace clothbench

#include "scenario/load.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cstdlib>
#include <filesystem>
#include <fstream>

#include "base/files.hpp"
#include "base/json_text.hpp"
#include "refusal.hpp"
#include "scenario/study.hpp"
#include "with_folder.hpp"

namespace clothbench {
namespace {

namespace fs = std::filesystem;

const char* const kGood = R"({"name":"x","why":"A scene for tests.","cloth":{"grid":[8,6],"size_m":[1,0.5],
  "areal_density_kg_per_m2":0.2,"sides":"single"},"material":{"membrane_stiffness_N_per_m":1000},
  "time":{"frame_rate_hz":72,"duration_s":1}})";

Scene scene_of(const std::string& text) { return scene_from_json(parse_json(text, "test.json"), "test.json"); }
std::string message_of(const std::string& text) {
  return refusal([&] { scene_of(text); }, ExitCode::BadInput);
}

/// kGood with one change.
std::string changed(const std::string& from, const std::string& to) { return replaced(kGood, from, to); }

TEST(Load, CompletesDefaults) {
  const Scene s = scene_of(kGood);
  EXPECT_EQ(s.gravity_m_per_s2, (Vec3{0, -9.81, 0}));
  EXPECT_EQ(s.cloth.axis_v, (Vec3{0, 0, 1}));
  EXPECT_EQ(s.time.frames(), 72);
  EXPECT_EQ(s.needs, (FeatureSet{Feature::Stretch, Feature::Shear}));
  EXPECT_EQ(s.sha256.size(), 64u);
  EXPECT_EQ(scene_of(s.json).sha256, s.sha256) << "the stored scenario is complete";
}

TEST(Load, NeedsFollowTheScene) {
  EXPECT_TRUE(scene_of(changed("1000}", "1000,\"bending_rigidity_N_m\":1e-5}")).needs.has(Feature::Bend));
  EXPECT_TRUE(scene_of(changed("1000}", "1000,\"damping_per_s\":0.1}")).needs.has(Feature::Damping));
  EXPECT_TRUE(scene_of(changed("single", "double-duplicated")).needs.has(Feature::DuplicatedLayer));
  EXPECT_FALSE(scene_of(changed("single", "double")).needs.has(Feature::DoubleSided))
      << "two-sided contact needs something to touch";
}

TEST(Load, PinsBecomeVertices) {
  const Scene s = scene_of(
      changed("\"time\"", R"("pins":[{"corners":["u0v0","u1v1"]},{"edge":"v0"},{"vertices":[9,0,9]}],"time")"));
  EXPECT_EQ(s.pins.vertices, (std::vector<std::uint32_t>{0, 1, 2, 3, 4, 5, 6, 7, 9, 47}));
}

TEST(Load, OverridesAreChecked) {
  const auto load = [](const std::string& set) { return scene_from_json(parse_json(kGood, "t"), "t", {set}); };
  EXPECT_EQ(load("cloth.grid=[64,32]").cloth.columns, 64);
  EXPECT_EQ(load("cloth.sides=double").cloth.sides, Sides::Double);
  for (const char* bad :
       {"cloth.grid", "=1", "cloth.gird=[2,2]", "cloth.grid=[1,1]", "name.x=1", "cloth.size_m=[NaN,1]"})
    EXPECT_THROW(load(bad), Error) << bad;
}

TEST(Load, SelfCollisionIsAsThickAsItsTrianglesAreHighAtMost) {
  const auto load = [](const std::string& set) {
    return scene_from_json(parse_json(kGood, "t"), "t", {"cloth.grid=[11,21]", "cloth.size_m=[0.4,0.6]", set});
  };
  const Scene s = load("cloth.self_collision={\"thickness_m\":0.02}");
  EXPECT_EQ(s.cloth.self_collision.thickness_m, 0.02);
  EXPECT_EQ(s.cloth.self_collision.friction, 0);
  EXPECT_TRUE(s.needs.has(Feature::SelfCollision));
  EXPECT_FALSE(s.needs.has(Feature::Friction));
  EXPECT_TRUE(load("cloth.self_collision={\"thickness_m\":0.02,\"friction\":0.1}").needs.has(Feature::Friction));
  EXPECT_FALSE(load("cloth.sides=double").needs.has(Feature::SelfCollision));
  // Cells of 40 mm x 30 mm: half of one is 24 mm high.
  EXPECT_NEAR(s.cloth.least_height_m(), 0.024, 1e-15);
  EXPECT_PRED2(mentions, refusal([&] { load("cloth.self_collision={\"thickness_m\":0.0241}"); }),
               "/cloth/self_collision/thickness_m: expected at most")
      << "the flat cloth would already touch itself";
  for (const char* bad :
       {"{\"thickness_m\":0}", "{\"thickness_m\":-1}", "{}", "true", "{\"thickness_m\":0.01,\"width\":1}"})
    EXPECT_THROW(load(std::string("cloth.self_collision=") + bad), Error) << bad;
}

/// A text of kGood and its replacement; a replacement of nothing is added before "time".
TEST(Load, WhatIsWrongIsOneLineWithItsPlace) {
  const struct {
    std::string from, to;
    const char *place, *hint;
  } bad[] = {
      {"\"grid\"", "\"gird\"", "/cloth/gird", "grid"},
      {"\"size_m\"", "\"size_cm\"", "/cloth/size_cm", "size_m"},
      {"1000", "NaN", "line 2", "not valid JSON"},
      {"1000", "1e999", "line 2", "range"},
      {"\"duration_s\":1", "\"duration_s\":1,", "line 3", "not valid JSON"},
      {"[1,0.5]", "[1,0]", "/cloth/size_m/1", "> 0"},
      {"[8,6]", "[1,1]", "/cloth/grid/0", ">= 2"},
      {"[8,6]", "[1000000,1000000]", "/cloth/grid/0", "<= 4096"},
      {"[8,6]", "[4096,4096]", "/cloth/grid", "vertices"},
      {"[8,6]", "[8.5,6]", "/cloth/grid/0", "integer"},
      {"[8,6]", "[8,6,4]", "/cloth/grid", "2 items"},
      {"0.2", "\"0.2\"", "/cloth/areal_density_kg_per_m2", "number"},
      {"0.2", "null", "/cloth/areal_density_kg_per_m2", "number"},
      {"0.2", "0", "/cloth/areal_density_kg_per_m2", "> 0"},
      {"", R"("gravity_m_per_s2":[0,null,0])", "/gravity_m_per_s2/1", "number"},
      {"\"duration_s\":1", "\"duration_s\":0", "/time/duration_s", "> 0"},
      {"\"duration_s\":1", "\"duration_s\":1e9", "/time/duration_s", "86400"},
      {"\"duration_s\":1", "\"duration_s\":1e-9", "/time/duration_s", "frame"},
      {"\"single\"", "\"both\"", "/cloth/sides", "double-duplicated"},
      {"\"sides\":\"single\"", "\"pose\":{}", "/cloth", "sides"},
      {"1000", "\"rigid\"", "/material/membrane_stiffness_N_per_m", "inextensible"},
      {"1000", "0", "/material/membrane_stiffness_N_per_m", "> 0"},
      {"1000", "1000,\"bending_rigidity_N_m\":-1", "/material/bending_rigidity_N_m", ">= 0"},
      {"\"why\"", "\"name\":\"y\",\"why\"", "/name", "twice"},
      {"\"x\"", "\"\"", "/name", "string"},
      {"", R"("pins":[{"vertices":[0,48]}])", "/pins/0/vertices/1", "48"},
      {"", R"("pins":[{"edge":"v0","vertices":[1]}])", "/pins/0", "object"},
      {"\"sides\"", R"("pose":{"axis_u":[2,0,0]},"sides")", "/cloth/pose/axis_u", "length 1"},
      {"\"sides\"", R"("pose":{"axis_u":[0,0,1]},"sides")", "/cloth/pose/axis_v", "perpendicular"},
      {"\"sides\"", R"("pose":{"over_table":{"at":"center","drop_m":0.3}},"sides")", "/cloth/pose/over_table/collider",
       "with a table"},
      {"", R"("truth":{})", "/truth", "object"},
      {"", R"("truth":{"case":"free-fall","converged":{"substeps":8}})", "/truth", "object"},
      {"", R"("truth":{"converged":{}})", "/truth/converged", "\"substeps\" is missing"},
      {"", R"("truth":{"converged":{"substeps":8,"grid":[9,9]}})", "/truth/converged/grid", "unknown key"},
      {"", R"("truth":{"converged":{"substeps":8,"starts":1}})", "/truth/converged/starts", ">= 2"},
      {"", R"("colliders":[{}])", "/colliders/0", "\"type\" is missing"},
      {"", R"("colliders":[{"type":"cone"}])", "/colliders/0/type", "one of"},
      {"", R"("colliders":[{"type":"sphere","center_m":[0,0,0]}])", "/colliders/0", "\"radius_m\" is missing"},
      {"", R"("colliders":[{"type":"sphere","center_m":[0,0,0],"radius_m":1,"normal":[0,1,0]}])", "/colliders/0/normal",
       "unknown key"},
      {"", R"("colliders":[{"type":"plane","point_m":[0,0,0],"normal":[0,1,1]}])", "/colliders/0/normal", "length 1"},
      {"", R"("colliders":[{"type":"hand_mesh","track":"nowhere.json"}])", "/colliders/0/track", "no such file"},
      {"", R"("colliders":[{"type":"mesh","positions_m":[[0,0,0],[1,0,0],[0,0,1]],"triangles":[[0,1,3]]}])",
       "/colliders/0/triangles/0/2", "vertex 3 of 3"},
      {"", R"("colliders":[{"type":"mesh","positions_m":[[0,0,0],[1,0,0],[0,0,1]],"triangles":[]}])",
       "/colliders/0/triangles", "at least 1 items"},
      {"", R"("assumed":["/cloth/colour"])", "/assumed/0", "/cloth/colour"},
  };
  for (const auto& b : bad) {
    const std::string message =
        message_of(b.from.empty() ? changed("\"time\"", b.to + ",\"time\"") : changed(b.from, b.to));
    for (const char* part : {"test.json", b.place, b.hint}) EXPECT_PRED2(mentions, message, part) << b.to;
    EXPECT_EQ(std::count(message.begin(), message.end(), '\n'), 0) << message;
  }
}

TEST(Load, TextThatIsNoJson) {
  for (const std::string& text :
       {std::string(""), std::string("hello"), std::string("{"), std::string("\x00\xff\xfe", 3), std::string("[1,2"),
        std::string(kGood).substr(0, 100), std::string(100000, '['), std::string("{\"name\":\"\xc3\x28\"}")}) {
    EXPECT_PRED2(mentions, message_of(text), "test.json");
  }
  EXPECT_PRED2(mentions, message_of("[]"), "expected object");
}

TEST(Load, ASceneIsFoundByTheNameThatTablesShow) {
  EXPECT_EQ(find_scenario("box-drop").lexically_relative(scenario_root()), "contact/box.json");
  EXPECT_PRED2(mentions, refusal([] { find_scenario("box-dorp"); }), "no such file, nor a scene");
}

TEST(Load, FilesThatCannotBeRead) {
  EXPECT_THROW(load_scene("/no/such/scene.json"), Error);
  EXPECT_THROW(load_scene(fs::temp_directory_path().string()), Error);
  const ScratchFolder folder;
  const std::string big = folder.file("big.json", std::string((16u << 20) + 1, ' '));
  EXPECT_PRED2(mentions, refusal([&] { load_scene(big); }), "bytes") << "a file over 16 MiB";
}

TEST(Load, EveryShippedFileLoads) {
  int scenes = 0, studies = 0;
  for (const auto& file : fs::recursive_directory_iterator(CLOTHBENCH_SOURCE_DIR "/scenarios")) {
    const std::string path = file.path().string();
    if (file.path().extension() != ".json" || path.find("/schema/") != std::string::npos ||
        path.find("/assets/") != std::string::npos)
      continue;
    if (is_study(path)) {
      EXPECT_NO_THROW(load_study(path)) << path;
      ++studies;
    } else {
      EXPECT_NO_THROW(load_scene(path)) << path;
      ++scenes;
    }
  }
  EXPECT_GE(scenes, 1);
  EXPECT_GE(studies, 1);
}

constexpr DataFolder kFolder{"test files", "CLOTHBENCH_DATA_FOLDER_TEST", "installed/here", "built/there"};

class DataFolderTest : public WithFolder {
 protected:
  std::string why() const {
    return refusal([&] { find_data(kFolder, roots_); });
  }

  const Variable unset_{kFolder.variable, nullptr};
  DataRoots roots_{dir_ / "share", dir_ / "source"};
};

TEST_F(DataFolderTest, VariableThenInstalledThenSource) {
  const fs::path source = roots_.source / "built/there", installed = roots_.installed / "installed/here",
                 named = dir_ / "named";
  fs::create_directories(source);
  EXPECT_EQ(find_data(kFolder, roots_), source);
  fs::create_directories(installed);
  EXPECT_EQ(find_data(kFolder, roots_), installed);
  fs::create_directories(named);
  setenv(kFolder.variable, named.c_str(), 1);
  EXPECT_EQ(find_data(kFolder, roots_), named);
  setenv(kFolder.variable, "", 1);  // same as not set
  EXPECT_EQ(find_data(kFolder, roots_), installed);
}

TEST_F(DataFolderTest, OneErrorNamesEveryPlace) {
  const fs::path installed = roots_.installed / "installed/here", source = roots_.source / "built/there",
                 named = dir_ / "nowhere";
  fs::create_directories(source.parent_path());
  std::ofstream(source) << "a file is no folder";
  for (const std::string& place :
       {std::string("CLOTHBENCH_DATA_FOLDER_TEST"), installed.string(), source.string(), std::string("test files")})
    EXPECT_PRED2(mentions, why(), place);
  fs::create_directories(installed);
  setenv(kFolder.variable, named.c_str(), 1);  // a wrong variable is not ignored
  for (const fs::path& place : {named, installed, source}) EXPECT_PRED2(mentions, why(), place.string());
}

TEST_F(DataFolderTest, AProgramOfUnknownPlaceStillHasItsSourceTree) {
  roots_.installed.clear();
  EXPECT_EQ(usual_places(kFolder, roots_), std::vector<fs::path>{roots_.source / "built/there"});
}

TEST_F(DataFolderTest, ASceneByItsPathNeedsNoScenarioFolder) {
  const std::string scene = CLOTHBENCH_SOURCE_DIR "/scenarios/validation/hang-mesh.json";
  ASSERT_EQ(load_scene(scene).name, "hang-mesh");
  fs::copy(CLOTHBENCH_SOURCE_DIR "/scenarios/assets", dir_ / "assets", fs::copy_options::recursive);
  fs::copy_file(scene, dir_ / "hang-mesh.json");
  const Variable none("CLOTHBENCH_SCENARIOS", "/nonexistent");
  EXPECT_EQ(load_scene((dir_ / "hang-mesh.json").string()).name, "hang-mesh");
  EXPECT_THROW(load_scene("paper/gravity"), Error);
}

}  // namespace
}  // namespace clothbench

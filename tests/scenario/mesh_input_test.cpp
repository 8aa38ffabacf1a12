// Contents of a mesh file other than triangles: seams, names; glTF as well as OBJ.
#include <gtest/gtest.h>

#include <cstring>
#include <set>

#include "assets/base64.hpp"
#include "scenario/cloth_mesh.hpp"
#include "scenario/load.hpp"
#include "scratch_folder.hpp"

namespace clothbench {
namespace {

using nlohmann::json;

// Two triangles of a unit square that meet along a seam: vertices 2 and 3 occur twice. The panels have separate texture
// coordinates, which are not read.
constexpr char kPanels[] =
    "o front\nv 0 0 0\nv 1 0 0\nv 0 1 0\nvt 0 0\nvt 0.5 0\nvt 0 0.5\ng waist left\nf 1/1 2/2 3/3\n"
    "o back\nv 1 0 0\nv 1 1 0\nv 0 1 0\nvt 2 0\nvt 2 1\nvt 1 1\ng\nf 4/4 5/5 6/6\n";

class MeshInput : public ::testing::Test {
 protected:
  MeshInput() { folder.file("panels.obj", kPanels); }
  Scene scene_of(const char* file, const char* pointer, const json& value) const {
    json j = mesh_scenario({{"file", file}});
    if (*pointer != 0) j[json::json_pointer(pointer)] = value;
    return load_scene(folder.file("panels.json", j.dump()));
  }
  const ScratchFolder folder;
};

TEST_F(MeshInput, WeldsVerticesInOnePlaceWithANotice) {
  ::testing::internal::CaptureStderr();
  const Scene s = scene_of("panels.obj", "", {});
  EXPECT_PRED2(mentions, ::testing::internal::GetCapturedStderr(), "2 vertices");
  EXPECT_EQ(s.cloth.vertex_count(), 4u);
  EXPECT_EQ(s.cloth.mesh->edges.size(), 5u) << "one seam";
  EXPECT_EQ(s.cloth.mesh->triangles[1], (std::array<std::uint32_t, 3>{1, 3, 2}));
}

TEST_F(MeshInput, NamesOfFacesAreGroupsOfVertices) {
  const auto pins = [&](const char* group) {
    return scene_of("panels.obj", "/pins", {{{"group", group}}}).pins.vertices;
  };
  EXPECT_EQ(pins("waist"), (std::vector<std::uint32_t>{0, 1, 2}));
  EXPECT_EQ(pins("left"), pins("waist")) << "a face may have several names";
  EXPECT_EQ(pins("front"), pins("waist"));
  EXPECT_EQ(pins("back"), (std::vector<std::uint32_t>{1, 2, 3})) << "the seam belongs to both";
  const std::string unknown = refusal([&] { pins("wrist"); });
  EXPECT_PRED2(mentions, unknown, "/pins/0/group");
  EXPECT_PRED2(mentions, unknown, "one of: back, front, left, waist");
  const Scene held = scene_of("panels.obj", "/grips", {{{"group", "waist"}, {"velocity_m_per_s", {0, 1, 0}}}});
  EXPECT_EQ(held.grips.vertices, (std::vector<std::uint32_t>{0, 1, 2}));
  const Scene heavy = scene_of("panels.obj", "/cloth/mass_factors", {{{"group", "back"}, {"factor", 3}}});
  EXPECT_EQ(heavy.cloth.mass_factors, (std::vector<double>{1, 3, 3, 3}));
  EXPECT_PRED2(mentions, refusal([&] {
                 scene_of("panels.obj", "/grips", {{{"velocity_m_per_s", {0, 1, 0}}}});
               }),
               "/grips/0");
}

TEST_F(MeshInput, StartsCrumpledToo) {
  const Scene ball = scene_of("panels.obj", "/cloth/start", {{"shape", "sphere"}, {"radius_m", 0.25}});
  const std::vector<double> x = initial_positions(ball);
  for (std::size_t v = 0; v < 4; ++v) EXPECT_NEAR(std::hypot(x[3 * v], x[3 * v + 1], x[3 * v + 2]), 0.25, 1e-12);
  const Scene folded = scene_of("panels.obj", "/cloth/start", {{"shape", "folded"}, {"folds", 2}});
  EXPECT_EQ(initial_positions(folded)[3], 0) << "x = 1 is folded back onto x = 0";
}

/// A text glTF of one square: positions, texture coordinates and 16-bit indices in one buffer.
json square_gltf() {
  const float x[12] = {0, 0, 0, 1, 0, 0, 1, 1, 0, 0, 1, 0}, uv[8] = {0, 0, 1, 0, 1, 1, 0, 1};
  const std::uint16_t index[6] = {0, 1, 2, 0, 2, 3};
  std::string bytes(sizeof(x) + sizeof(uv) + sizeof(index), 0);
  std::memcpy(bytes.data(), x, sizeof(x));
  std::memcpy(bytes.data() + sizeof(x), uv, sizeof(uv));
  std::memcpy(bytes.data() + sizeof(x) + sizeof(uv), index, sizeof(index));
  return {
      {"asset", {{"version", "2.0"}}},
      {"nodes", {{{"name", "cape"}, {"mesh", 0}, {"scale", {2, 2, 2}}, {"translation", {0, 0, 5}}}}},
      {"meshes",
       {{{"name", "cloth"},
         {"primitives", {{{"attributes", {{"POSITION", 0}, {"TEXCOORD_0", 1}}}, {"indices", 2}, {"material", 0}}}}}}},
      {"materials", {{{"name", "silk"}}}},
      {"accessors",
       {{{"bufferView", 0}, {"componentType", 5126}, {"count", 4}, {"type", "VEC3"}},
        {{"bufferView", 1}, {"componentType", 5126}, {"count", 4}, {"type", "VEC2"}},
        {{"bufferView", 2}, {"componentType", 5123}, {"count", 6}, {"type", "SCALAR"}}}},
      {"bufferViews",
       {{{"buffer", 0}, {"byteOffset", 0}, {"byteLength", 48}},
        {{"buffer", 0}, {"byteOffset", 48}, {"byteLength", 32}},
        {{"buffer", 0}, {"byteOffset", 80}, {"byteLength", 12}}}},
      {"buffers",
       {{{"byteLength", bytes.size()},
         {"uri", "data:application/octet-stream;base64," +
                     assets::encode_base64(reinterpret_cast<const std::uint8_t*>(bytes.data()), bytes.size())}}}}};
}

/// The same glTF as a .glb, with its buffer outside the text.
std::string binary(json j) {
  const std::string uri = j["buffers"][0]["uri"];
  const std::vector<std::uint8_t> bytes = assets::decode_base64(uri.substr(uri.find(',') + 1), "file", "/uri");
  std::string data(bytes.begin(), bytes.end());
  j["buffers"][0].erase("uri");
  std::string text = j.dump();
  text.resize((text.size() + 3) / 4 * 4, ' ');
  data.resize((data.size() + 3) / 4 * 4, 0);
  std::string out = "glTF";
  const auto word = [&](std::size_t value) {
    const auto w = static_cast<std::uint32_t>(value);
    out.append(reinterpret_cast<const char*>(&w), 4);
  };
  word(2), word(12 + 8 + text.size() + 8 + data.size());
  word(text.size()), out += "JSON" + text;
  word(data.size()), out += std::string("BIN\0", 4) + data;
  return out;
}

TEST_F(MeshInput, ReadsGltf) {
  folder.file("square.gltf", square_gltf().dump());
  folder.file("square.glb", binary(square_gltf()));
  for (const char* file : {"square.gltf", "square.glb"}) {
    const Scene s = scene_of(file, "/pins", {{{"group", "silk"}}});
    EXPECT_EQ(s.cloth.mesh->vertices, (std::vector<Vec3>{{0, 0, 5}, {2, 0, 5}, {2, 2, 5}, {0, 2, 5}}))
        << file << ": placed by its node";
    EXPECT_EQ(s.cloth.mesh->triangles.size(), 2u);
    for (const char* group : {"cape", "cloth", "silk"}) EXPECT_EQ(s.cloth.mesh->groups.at(group).size(), 4u) << group;
    EXPECT_EQ(s.pins.vertices.size(), 4u);
  }
}

TEST_F(MeshInput, OfAGltfTheActiveSceneIsRead) {
  json j = square_gltf();
  j["nodes"].push_back({{"name", "unused"}, {"mesh", 0}, {"translation", {9, 0, 0}}});
  j["nodes"].push_back({{"name", "parent"}, {"children", {1}}});
  const auto vertices = [&] { return assets::parse_gltf(j.dump(), "m.gltf").vertices.size(); };
  EXPECT_EQ(vertices(), 8u) << "a file without scenes is read whole";
  j["scenes"] = {{{"nodes", {0}}}};
  EXPECT_EQ(vertices(), 4u) << "the only scene";
  j["scene"] = 0;
  EXPECT_EQ(vertices(), 4u);
  j["scenes"].push_back({{"nodes", {0, 2}}});
  EXPECT_EQ(vertices(), 4u);
  j["scene"] = 1;
  EXPECT_EQ(vertices(), 8u) << "with the children of its nodes";
  EXPECT_EQ(assets::parse_gltf(binary(j), "m.glb").vertices.size(), 8u);
  j.erase("scene");
  EXPECT_EQ(refusal([&] { vertices(); }).find("m.gltf: /scene: missing"), 0u) << refusal([&] { vertices(); });
  j["scene"] = 2;
  EXPECT_EQ(refusal([&] { vertices(); }).find("m.gltf: /scenes: index 2"), 0u) << refusal([&] { vertices(); });
}

TEST_F(MeshInput, MorphTargetsMoveTheirVertices) {
  json j = square_gltf();
  // The positions as displacements: each weight adds the square's coordinates once more.
  j["meshes"][0]["primitives"][0]["targets"] = {{{"POSITION", 0}}, {{"NORMAL", 0}}};
  const auto corner = [&] { return assets::parse_gltf(j.dump(), "m.gltf").vertices.at(2); };
  EXPECT_EQ(corner(), (Vec3{2, 2, 5}));
  j["meshes"][0]["weights"] = {0.5, 1};
  EXPECT_EQ(corner(), (Vec3{3, 3, 5}));
  j["nodes"][0]["weights"] = {2, 0};
  EXPECT_EQ(corner(), (Vec3{6, 6, 5})) << "the node's values replace its mesh's";
  j["nodes"][0]["weights"] = {2};
  EXPECT_PRED2(mentions, refusal(corner), "/meshes/0/primitives/0/targets: 2 morph targets, but 1 weights");
}

TEST_F(MeshInput, WhatAGltfNeedsIsRefusedByName) {
  const auto why = [](const char* pointer, const json& value) {
    json j = square_gltf();
    j[json::json_pointer(pointer)] = value;
    const std::string text = refusal([&] { assets::parse_gltf(j.dump(), "m.gltf"); });
    const std::string bytes = refusal([&] { assets::parse_gltf(binary(j), "m.gltf"); });
    EXPECT_EQ(text.empty(), bytes.empty());
    if (text.starts_with("m.gltf: /")) {
      EXPECT_EQ(text, bytes);
    }
    return text;
  };
  EXPECT_EQ(why("/extensionsRequired", {"KHR_materials_unlit", "KHR_texture_transform"}), "");
  for (const char* needed :
       {"KHR_mesh_quantization", "KHR_draco_mesh_compression", "EXT_meshopt_compression", "MY_own"})
    EXPECT_PRED2(mentions, why("/extensionsRequired", {"KHR_materials_unlit", needed}),
                 std::string("m.gltf: /extensionsRequired/1: \"") + needed + "\" is not supported");
  EXPECT_EQ(why("/asset", {{"version", "2.1"}}), "") << "a later minor version is read as this one";
  for (const char* version : {"1.0", "3.0", "20", ""}) EXPECT_NE(why("/asset", {{"version", version}}), "") << version;
  EXPECT_PRED2(mentions, why("/asset", {{"version", "2.1"}, {"minVersion", "2.1"}}), "/asset/minVersion: \"2.1\"");
  EXPECT_NE(why("/asset", json::object()), "");
  std::string old = binary(square_gltf());
  old[4] = 1;
  EXPECT_EQ(refusal([&] { assets::parse_gltf(old, "m.glb"); }),
            "m.glb: not a binary glTF file of version 2: its version is 1");
}

TEST_F(MeshInput, NamesOfFilesMayEndInCapitals) {
  folder.file("PANELS.OBJ", kPanels);
  folder.file("SQUARE.GLTF", square_gltf().dump());
  folder.file("SQUARE.Glb", binary(square_gltf()));
  folder.file("square.stl", kPanels);
  for (const char* file : {"PANELS.OBJ", "SQUARE.GLTF", "SQUARE.Glb"}) {
    const std::string scene = folder.file("SCENE.JSON", mesh_scenario({{"file", file}}).dump());
    EXPECT_EQ(load_scene(scene).cloth.vertex_count(), 4u) << file;
  }
  EXPECT_PRED2(mentions, refusal([&] { scene_of("square.stl", "", {}); }),
               "/cloth/mesh/file: expected a file whose name");
}

TEST_F(MeshInput, MirroredNodesKeepTheirFrontOutside) {
  json j = square_gltf();
  j["nodes"][0]["scale"] = {-1, 1, 1};
  EXPECT_EQ(assets::parse_gltf(j.dump(), "m.gltf").vertices[0], (Vec3{-1, 1, 5})) << "the last corner comes first";
}

TEST_F(MeshInput, RefusesBadGltfNamingThePlace) {
  const auto message = [](const char* pointer, const json& value) {
    json j = square_gltf();
    j[json::json_pointer(pointer)] = value;
    return refusal([&] { cloth_mesh(assets::parse_gltf(j.dump(), "m.gltf"), "m.gltf"); });
  };
  for (const auto& [pointer, value, expected] : std::vector<std::tuple<const char*, json, const char*>>{
           {"/buffers/0/uri", "/etc/passwd", "/buffers/0/uri: expected the buffer inside"},
           {"/meshes/0/primitives/0/mode", 1, "/meshes/0/primitives/0/mode: expected triangles"},
           {"/meshes/0/primitives/0/attributes", {{"NORMAL", 0}}, "\"POSITION\" is missing"},
           {"/accessors/0/bufferView", 9, "/bufferViews: index 9"},
           {"/accessors/2/componentType", 5121, "has no area"},
           {"/accessors/2/count", 7, "/accessors/2"},
           {"/nodes", json::array({{{"name", "empty"}}}), "/nodes: expected a node with a mesh"},
           {"/nodes/0/skin", 0, "/nodes/0/skin"}}) {
    EXPECT_PRED2(mentions, message(pointer, value), expected) << pointer << ": " << message(pointer, value);
    EXPECT_EQ(message(pointer, value).find("m.gltf"), 0u);
  }
  EXPECT_PRED2(mentions, refusal([] { assets::parse_gltf("glTF, but no more", "cut.glb"); }),
               "cut.glb: not a binary glTF");
  EXPECT_PRED2(mentions, refusal([] { assets::parse_gltf("{", "cut.gltf"); }), "cut.gltf");
}

/// tinygltf skips a value of a wrong type. This test replaces each value, list and object of a file by others.
TEST_F(MeshInput, RefusesEachWrongTypeInAGltfNamingThePlace) {
  json whole = square_gltf();
  whole.update({{"scene", 0},
                {"scenes", {{{"nodes", {0}}}}},
                {"extensionsUsed", {"KHR_materials_unlit"}},
                {"extensionsRequired", {"KHR_materials_unlit"}},
                {"skins", {{{"inverseBindMatrices", 0}, {"joints", {0}}}}}});
  whole["asset"]["minVersion"] = "2.0";
  whole["nodes"][0].update({{"children", {0}},
                            {"skin", 0},
                            {"translation", {0.5, 0.5, 0.5}},
                            {"rotation", {0.5, 0.5, 0.5, 0.5}},
                            {"scale", {0.5, 0.5, 0.5}},
                            {"matrix", std::vector<double>(16, 0.5)},
                            {"weights", {0.5}}});
  whole["meshes"][0]["weights"] = {0.5};
  whole["meshes"][0]["primitives"][0].update({{"mode", 4}, {"targets", {{{"POSITION", 0}}}}});
  whole["accessors"][0].update({{"byteOffset", 0}, {"normalized", false}, {"sparse", json::object()}});
  whole["bufferViews"][0]["byteStride"] = 12;
  std::set<json::json_pointer> places;
  const json flat = whole.flatten();
  for (const auto& [pointer, unused] : flat.items())
    for (json::json_pointer at(pointer); !at.empty(); at.pop_back()) places.insert(at);
  std::size_t tried = 0;
  for (const json::json_pointer& at : places)
    for (const json& wrong : {json("3"), json(true), json(1.5), json::object()}) {
      if (whole.at(at).type() == wrong.type()) continue;
      json j = whole;
      j[at] = wrong;
      const std::string why = refusal([&] { assets::parse_gltf(j.dump(), "m.gltf"); });
      EXPECT_TRUE(why.starts_with("m.gltf: " + at.to_string() + ": expected ")) << at << wrong << why;
      EXPECT_TRUE(why.ends_with("; found " + wrong.dump())) << at << wrong << why;
      ++tried;
    }
  whole["accessors"][0]["count"] = "4";
  EXPECT_EQ(refusal([&] { assets::parse_gltf(binary(whole), "m.glb"); }),
            "m.glb: /accessors/0/count: expected integer, >= 0; found \"4\"");
  EXPECT_GT(tried, 300u);
}

TEST_F(MeshInput, FilesThatAreTooLargeAreNotRead) {
  const std::string path = folder.file("huge.obj", "");
  std::filesystem::resize_file(path, std::uintmax_t{300} << 20);  // occupies no disk space
  EXPECT_PRED2(mentions, refusal([&] { scene_of("huge.obj", "", {}); }), "at most 268435456 are read");
}

TEST_F(MeshInput, RegionsAreTheTrianglesOfAGroup) {
  const auto regions = [&](const json& list) { return scene_of("panels.obj", "/material/regions", list); };
  const Scene s = regions({{{"group", "waist"}, {"membrane_stiffness_N_per_m", 100}}});
  EXPECT_TRUE(s.needs.has(Feature::Regions));
  EXPECT_EQ(triangle_stiffnesses(s), (std::vector<std::optional<double>>{100, 1000}));
  // The seam is the longest edge; its stiffness is the mean over its two triangles.
  const ClothMesh& mesh = *s.cloth.mesh;
  const std::vector<std::optional<double>> of_edges = edge_stiffnesses(s);
  ASSERT_EQ(of_edges.size(), mesh.edges.size());
  for (std::size_t e = 0; e < mesh.edges.size(); ++e) {
    const bool seam = mesh.edges[e].rest_m > 1.2, back = !seam && mesh.edges[e].b == 3;
    EXPECT_DOUBLE_EQ(of_edges[e].value(), seam ? 550 : back ? 1000 : 100) << e;
    EXPECT_EQ(membrane_stiffness(s, mesh.edges[e]), of_edges[e]) << e;
  }
  const Scene later = regions({{{"group", "back"}, {"membrane_stiffness_N_per_m", 100}},
                               {{"group", "back"}, {"membrane_stiffness_N_per_m", "inextensible"}}});
  EXPECT_FALSE(triangle_stiffnesses(later)[1].has_value());
  for (std::size_t e = 0; e < mesh.edges.size(); ++e)
    EXPECT_EQ(edge_stiffnesses(later)[e].has_value(), mesh.edges[e].a == 0) << "one inextensible triangle is enough";
}

TEST_F(MeshInput, RegionsThatAMeshOrAGridDoesNotHaveAreRefused) {
  const json mesh = mesh_scenario({{"file", "panels.obj"}});
  json grid = mesh, drawn = mesh;
  grid["cloth"].erase("mesh");
  grid["cloth"].update({{"grid", {4, 3}}, {"size_m", {1, 1}}});
  drawn["cloth"]["mesh"] = {{"drawn", {{"size_m", {1, 0.5}}, {"cells", 8}}}};
  for (const auto& [scenario, region, expected] : std::vector<std::tuple<json, json, std::string>>{
           {mesh, {{"group", "cuff"}}, "/group: the mesh has no triangles in a group \"cuff\"; expected one of: back"},
           {mesh, {{"columns", {0, 1}}}, "/columns: expected a cloth that is a grid"},
           {mesh, json::object(), ": expected \"group\""},
           {grid, {{"group", "cuff"}}, "/group: expected a cloth that is a mesh"},
           {grid, json::object(), ": expected \"columns\""},
           {drawn, {{"group", "u0"}}, "/group: no triangle"}}) {  // a border has no triangle of its own
    json j = scenario;
    j["material"]["regions"] = json::array({region});
    j["material"]["regions"][0]["membrane_stiffness_N_per_m"] = 100;
    EXPECT_PRED2(mentions, refusal([&] { load_scene(folder.file("panels.json", j.dump())); }),
                 "panels.json: /material/regions/0" + expected);
  }
}

}  // namespace
}  // namespace clothbench

// Cloths of triangles: what is read of an OBJ file, what is refused, and the scene that comes of it.
#include "scenario/cloth_mesh.hpp"

#include <gtest/gtest.h>

#include <numeric>

#include "clothbench/error.hpp"
#include "scenario/load.hpp"
#include "scratch_folder.hpp"

namespace clothbench {
namespace {

using nlohmann::json;

constexpr char kSquare[] = "# a comment\no square\nv 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nvt 0 0\nf 1/1 2/1 3/1 4/1\n";

TEST(ClothMesh, IsReadFromAnObjFile) {
  const ClothMesh m = parse_obj(kSquare, "square.obj");
  EXPECT_EQ(m.vertices.size(), 4u);
  ASSERT_EQ(m.triangles.size(), 2u) << "a quadrilateral is cut in two";
  EXPECT_EQ(m.edges.size(), 5u);
  EXPECT_DOUBLE_EQ(std::accumulate(m.areas_m2.begin(), m.areas_m2.end(), 0.0), 3 * 1.0)
      << "each triangle at three edges";
  Cloth cloth;
  cloth.mesh = std::make_shared<const ClothMesh>(m);
  EXPECT_EQ(selected_vertices(cloth, {{"nearest_m", {{0.9, 0.8, 0}}}}, "test", "/pins/0"),
            std::vector<std::uint32_t>{2});
  EXPECT_EQ(longest_sides(m), (std::pair{1.0, 1.0}));
}

TEST(ClothMesh, HasNoUseForSkinWeightsWhateverEndsALine) {
  for (const char* weights : {"vw 0 -1 0.5\n", "vt 0 0\rvw 0 -1 0.5\n", "vt 0 0\r\nvw 0 1e17 1\r\n"})
    EXPECT_EQ(parse_obj(kSquare + std::string(weights), "square.obj").vertices.size(), 4u)
        << "the OBJ library would refuse, or worse";
}

TEST(ClothMesh, WhatAMarkACommentOrAContinuedLineHoldsIsRead) {
  const ClothMesh plain = parse_obj(kSquare, "square.obj");
  for (const char* same : {"\xEF\xBB\xBFv 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nf 1 2 3 4\n",
                           "v 0 0 0 # the first\nv 1 0 0\t# f 1 2 3\nv 1 1 0\nv 0 1 0\nf 1 2 3 4 # all \\\n",
                           "v 0 0 0\nv 1 \\\n0 0\nv 1 1 0\nv 0 1 0\nf 1 2 \\\r\n3 \\\r\n4\r\n",
                           "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nf -4 -3 -2 -1"}) {
    const ClothMesh m = parse_obj(same, "same.obj");
    EXPECT_EQ(m.vertices, plain.vertices) << same;
    EXPECT_EQ(m.triangles, plain.triangles) << same;
  }
  EXPECT_TRUE(parse_obj("g panel#1 #2\nv 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n", "m.obj").groups.contains("panel#1"));
}

TEST(ClothMesh, MakesAScene) {
  const ScratchFolder folder;
  folder.file("square.obj", kSquare);
  json j = mesh_scenario({{"file", "square.obj"}});
  j["cloth"]["pose"] = {{"center_m", {0, 2, 0}}};
  j["pins"] = {{{"nearest_m", {{0, 0, 0}, {1, 0, 0}}}}};
  const Scene s = load_scene(folder.file("square.json", j.dump()));
  EXPECT_EQ(s.cloth.vertex_count(), 4u);
  EXPECT_TRUE(s.needs.has(Feature::ClothMesh));
  EXPECT_FALSE(s.needs.has(Feature::Shear)) << "its diagonals are edges like the others";
  EXPECT_EQ(s.pins.vertices, (std::vector<std::uint32_t>{0, 1}));
  EXPECT_EQ(s.rest_position(2, 0), (Vec3{1, 2, 1})) << "x along axis_u, y along axis_v, from the centre";
  const std::vector<double> mass = vertex_masses(s);
  EXPECT_NEAR(std::accumulate(mass.begin(), mass.end(), 0.0), 0.3, 1e-15);
  EXPECT_EQ(triangles(s.cloth).size(), 2u);
  EXPECT_TRUE(edges(s.cloth, EdgeKind::SkipOne).empty());
  for (const Edge& e : edges(s.cloth, EdgeKind::Structural)) {
    const EdgeCell cell = edge_cell(s.cloth, e);
    // Van Gelder's spring: Y (A1 + A2) / l^2; here 1/2 on a side and 1 / 2 on the diagonal.
    EXPECT_NEAR(cell.across_m / cell.along_m, 0.5, 1e-15) << e.a << " " << e.b;
  }
  json again = json::parse(s.json);
  EXPECT_EQ(again["cloth"]["mesh"]["sha256"].get<std::string>().size(), 64u);
  again["cloth"]["mesh"]["sha256"] = std::string(64, '0');
  EXPECT_PRED2(mentions, refusal([&] { load_scene(folder.file("again.json", again.dump())); }), "/cloth/mesh/sha256");
}

struct BadMesh {
  const char *text, *expected;
};
class BadObj : public ::testing::TestWithParam<BadMesh> {};
INSTANTIATE_TEST_SUITE_P(
    , BadObj,
    ::testing::Values(
        BadMesh{"", "expected at least one triangle"},
        BadMesh{"v 0 0 0\nv 1 0 0\nv 0 1 0\n", "expected at least one triangle"},
        BadMesh{"v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 4\n", "mesh.obj: line 4: vertex 4 of 3"},
        BadMesh{"v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 -4\n", "mesh.obj: line 4: vertex -4 of 3"},
        BadMesh{"v 0 0 0\nv 1 0 0\nv 0 1 0\nf 0 1 2\n", "mesh.obj: line 4: vertex 0 of 3"},
        BadMesh{"v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3.5\n",
                "mesh.obj: line 4: \"3.5\": expected the numbers of a vertex"},
        BadMesh{"v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 4294967299\n",
                "mesh.obj: line 4: \"4294967299\": expected the numbers"},
        BadMesh{"v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2\n", "mesh.obj: line 4: expected at least three corners"},
        BadMesh{"v 0 0 0\r\nv 1 0 0\r\nv 0 1\r\nf 1 2 3\r\n", "mesh.obj: line 3: expected 3 numbers after \"v\""},
        BadMesh{"# v\n\nv 0 0 0 # a corner\nv 1 0x1p0 0\nv 0 1 0\nf 1 2 3\n",
                "mesh.obj: line 4: \"0x1p0\": expected a finite decimal"},
        BadMesh{"v 0 0 0\nv 1 \\\n 0 \\\n 0\nv 0 1 zero\nf 1 2 3\n", "mesh.obj: line 5: \"zero\""},
        BadMesh{"v 0 0 0\nv 2 2 0\nv 2 0 0\nv 0 1 0\nf \\\n1 2 3 4\n",
                "mesh.obj: line 5: the outline of the face crosses"},
        BadMesh{"v 0 0 0\nv 1 0 0\nv 2 0 0\nv 3 0 0\nf 1 2 3 4\n", "mesh.obj: line 5: a face that has no area"},
        BadMesh{"v 0 0 0\nv 1 0 0\nv 2 0 0\nf 1 2 3\n", "triangle 0 (vertices 0, 1, 2) has no area"},
        BadMesh{"v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 2\n", "has no area"},
        BadMesh{"v 0 0 0\nv 1 0 0\nv 0 1 0\nv 5 5 5\nf 1 2 3\n",
                "mesh.obj: line 4: vertex 3 (the first is 0) is in no triangle"},
        BadMesh{"v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\nf 3 2 1\n",
                "mesh.obj: line 5: triangles 0 and 1 have the same vertices"},
        BadMesh{"v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\nv 0 -1 0\nf 1 2 3\nf 1 2 4\nf 1 2 5\n", "more than two triangles"},
        BadMesh{"v 0 0 0\nv 1 0 0\nv 0 1 0\nv 1 1 0\nf 1 2 3\nf 2 3 4\n",
                "mesh.obj: line 6: triangles 0 and 1 are wound oppositely: both run from vertex 1 to 2"},
        BadMesh{"v 0 0 0\nv 1 0 0\nv 1 0 0\nf 1 2 3\n", "has no area"},
        BadMesh{"#\nv 0 nan 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n",
                "mesh.obj: line 2: \"nan\": expected a finite decimal number"},
        BadMesh{"v 1e400 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n", "mesh.obj"}));

TEST_P(BadObj, IsRefusedNamingFileAndWhat) {
  const std::string message = refusal([&] { parse_obj(GetParam().text, "mesh.obj"); });
  EXPECT_PRED2(mentions, message, "mesh.obj");
  EXPECT_PRED2(mentions, message, GetParam().expected);
}

TEST(ClothMesh, RefusesWhatIsOfGridsAlone) {
  const ScratchFolder folder;
  folder.file("square.obj", kSquare);
  const auto with = [&](const char* pointer, const json& value) {
    json j = mesh_scenario({{"file", "square.obj"}});
    j[json::json_pointer(pointer)] = value;
    return refusal([&] { load_scene(folder.file("square.json", j.dump())); });
  };
  for (const auto& [pointer, value] :
       std::vector<std::pair<const char*, json>>{{"/cloth/grid", {2, 2}},
                                                 {"/cloth/size_m", {1, 1}},
                                                 {"/cloth/pose/span_m", 0.5},
                                                 {"/pins", {{{"edge", "u0"}}}},
                                                 {"/pins", {{{"corners", {"u0v0"}}}}},
                                                 {"/grips", {{{"edge", "u0"}, {"velocity_m_per_s", {0, 0, 0}}}}},
                                                 {"/cloth/mass_factors", {{{"edge", "u0"}, {"factor", 2}}}},
                                                 {"/cloth/mesh/file", "none.obj"}})
    EXPECT_PRED2(mentions, with(pointer, value), pointer) << pointer << ": " << with(pointer, value);
  json neither = mesh_scenario({{"file", "square.obj"}});
  neither["cloth"].erase("mesh");
  EXPECT_PRED2(mentions, refusal([&] { load_scene(folder.file("neither.json", neither.dump())); }),
               "\"grid\" is missing");
  json pinned = neither;
  pinned["cloth"]["grid"] = {3, 3};
  pinned["cloth"]["size_m"] = {1, 1};
  pinned["pins"] = {{{"nearest_m", {{0, 0, 0}}}}};
  EXPECT_PRED2(mentions, refusal([&] { load_scene(folder.file("pinned.json", pinned.dump())); }), "/pins/0/nearest_m");
}

}  // namespace
}  // namespace clothbench

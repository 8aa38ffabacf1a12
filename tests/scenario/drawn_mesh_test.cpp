// Sheets of irregular triangles that are drawn by number.
#include <gtest/gtest.h>

#include <algorithm>
#include <numeric>

#include "clothbench/error.hpp"
#include "scenario/cloth_mesh.hpp"
#include "scenario/load.hpp"
#include "scratch_folder.hpp"

namespace clothbench {
namespace {

using nlohmann::json;

TEST(DrawnMesh, FillsItsRectangleAtAnyAngle) {
  for (const double angle : {0.0, 0.4, 0.8, 1.6})
    for (const double height : {0.25, 0.5, 2.0}) {
      const ClothMesh m = drawn_mesh({1, height, 12, angle, 0.3, 7});
      const double corners = std::accumulate(m.areas_m2.begin(), m.areas_m2.end(), 0.0);
      EXPECT_NEAR(corners / 3, height, 1e-3 * height) << "each triangle at three edges; angle " << angle;
      for (const Edge& e : m.edges) EXPECT_LE(e.rest_m, 2.5 / 12) << angle << " " << height;
      const std::size_t rows = m.groups.at("u0").size();
      EXPECT_EQ(rows, static_cast<std::size_t>(12 * height) + 1);
      EXPECT_EQ(m.groups.at("u1").size(), rows);
      EXPECT_EQ(m.groups.at("v0").size(), 13u);
      EXPECT_EQ(m.groups.at("v1").size(), 13u);
    }
}

TEST(DrawnMesh, IsFilledWhereFourPointsLieOnOneCircle) {
  for (const double width : {0.1, 0.6, 1.0, 3.7})
    for (const double angle : {0.0, 0.35})
      for (const int cells : {7, 31, 60}) {
        const ClothMesh m = drawn_mesh({width, width, cells, angle, 0, 1});
        const double corners = std::accumulate(m.areas_m2.begin(), m.areas_m2.end(), 0.0);
        EXPECT_NEAR(corners / 3, width * width, 1e-3 * width * width) << cells << " " << angle;
      }
}

TEST(DrawnMesh, IsTheSameForTheSameNumbers) {
  const DrawnSheet one{1, 0.25, 8, 0.5, 0.2, 3};
  DrawnSheet other = one;
  EXPECT_EQ(drawn_mesh(one).vertices, drawn_mesh(other).vertices);
  EXPECT_EQ(drawn_mesh(one).triangles, drawn_mesh(other).triangles);
  other.seed = 4;
  EXPECT_NE(drawn_mesh(one).vertices, drawn_mesh(other).vertices);
}

TEST(DrawnMesh, CopiesAreTheSameSheetElsewhere) {
  DrawnSheet sheet{1, 0.5, 6, 0.5, 0.2, 3};
  const ClothMesh one = drawn_mesh(sheet);
  sheet.copies = {3, 2};
  sheet.apart_m = {1.5, 0.25};
  const ClothMesh all = drawn_mesh(sheet);
  const std::size_t n = one.vertices.size();
  ASSERT_EQ(all.vertices.size(), 6 * n);
  EXPECT_EQ(all.triangles.size(), 6 * one.triangles.size());
  EXPECT_EQ(all.edges.size(), 6 * one.edges.size());
  EXPECT_EQ(all.groups.at("v1").size(), 6 * one.groups.at("v1").size());
  for (std::size_t copy = 0; copy < 6; ++copy)
    for (std::size_t v = 0; v < n; ++v) {
      const Vec3 &a = one.vertices[v], &b = all.vertices[copy * n + v];
      EXPECT_NEAR(b[0] - a[0], 1.5 * (static_cast<double>(copy / 2) - 1), 1e-12);
      EXPECT_EQ(b[1], a[1]);
      EXPECT_NEAR(b[2] - a[2], copy % 2 == 0 ? -0.125 : 0.125, 1e-12);
    }
}

TEST(DrawnMesh, HasAClampOfTwoStraightLinesIfAsked) {
  DrawnSheet sheet{1, 0.25, 16, 0.5, 0.3, 3};
  EXPECT_EQ(drawn_mesh(sheet).groups.count("clamp"), 0u);
  sheet.clamp = true;
  const ClothMesh m = drawn_mesh(sheet);
  EXPECT_NEAR(std::accumulate(m.areas_m2.begin(), m.areas_m2.end(), 0.0) / 3, 0.25, 2.5e-4);
  const auto& held = m.groups.at("clamp");
  EXPECT_EQ(held.size(), 5u + 2u + 4u) << "edge u0, two on the borders, a line between";
  for (std::uint32_t v = 0; v < m.vertices.size(); ++v) {
    const double x = m.vertices[v][0];
    EXPECT_TRUE(x == 0 || x >= 1.0 / 16) << x;
    EXPECT_EQ(std::count(held.begin(), held.end(), v), x <= 1.0 / 16);
  }
  for (const auto& t : m.triangles) {
    const auto [first, last] = std::minmax({m.vertices[t[0]][0], m.vertices[t[1]][0], m.vertices[t[2]][0]});
    EXPECT_TRUE(first > 0 || last <= 1.0 / 16) << "no triangle reaches across the clamp";
  }
}

TEST(DrawnMesh, IsAScenesCloth) {
  const json drawn = {{"size_m", {1, 0.5}}, {"cells", 8}, {"turned_deg", 30}, {"share", 0.2}};
  json pinned = mesh_scenario({{"drawn", drawn}});
  pinned["pins"] = {{{"group", "u0"}}};
  const Scene s = scene_from_json(pinned, "a test");
  EXPECT_TRUE(s.needs.has(Feature::ClothMesh));
  EXPECT_DOUBLE_EQ(s.cloth.width_m, 1);
  EXPECT_DOUBLE_EQ(s.cloth.height_m, 0.5);
  ASSERT_EQ(s.pins.vertices.size(), 5u);
  for (const std::uint32_t v : s.pins.vertices) EXPECT_EQ(s.cloth.mesh->vertices[v][0], -0.5) << "round center_m";
  EXPECT_EQ(scene_from_json(json::parse(s.json), "again").cloth.mesh->vertices, s.cloth.mesh->vertices);
}

TEST(DrawnMesh, RefusesOtherKeysBesideIt) {
  const json drawn = {{"size_m", {1, 0.5}}, {"cells", 8}};
  const auto message = [](const json& mesh) {
    return refusal([&] { scene_from_json(mesh_scenario(mesh), "a test"); });
  };
  for (const json& mesh :
       {json::object({{"sha256", std::string(64, '0')}}), json{{"drawn", drawn}, {"file", "sheet.obj"}}})
    EXPECT_PRED2(mentions, message(mesh), "/cloth/mesh: expected either \"file\" or \"drawn\"");
  EXPECT_PRED2(mentions, message({{"drawn", drawn}, {"sha256", std::string(64, '0')}}), "/cloth/mesh/sha256");
  EXPECT_PRED2(mentions, message({{"drawn", {{"size_m", {1, 1}}, {"cells", 1000}}}}), "at most 20000 vertices");
  EXPECT_PRED2(mentions, message({{"drawn", {{"size_m", {1, 1}}, {"cells", 8}, {"share", 0.6}}}}),
               "/cloth/mesh/drawn/share");
}

}  // namespace
}  // namespace clothbench

// Cloths of triangles: what is read from an OBJ file, what is refused, and the resulting scene.
#include "scenario/cloth_mesh.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <numeric>
#include <random>
#include <set>

#include "scenario/load.hpp"
#include "scratch_folder.hpp"

namespace clothbench {
namespace {

using nlohmann::json;

constexpr char kSquare[] = "# a comment\no square\nv 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nvt 0 0\nf 1/1 2/1 3/1 4/1\n";

ClothMesh mesh_of(const std::string& text, const std::string& source) {
  return cloth_mesh(read_obj(text, source), source);
}

TEST(ClothMesh, IsReadFromAnObjFile) {
  const ClothMesh m = mesh_of(kSquare, "square.obj");
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
    EXPECT_EQ(mesh_of(kSquare + std::string(weights), "square.obj").vertices.size(), 4u)
        << "the OBJ library would refuse, or worse";
}

TEST(ClothMesh, WhatAMarkACommentOrAContinuedLineHoldsIsRead) {
  const ClothMesh plain = mesh_of(kSquare, "square.obj");
  for (const char* same : {"\xEF\xBB\xBFv 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nf 1 2 3 4\n",
                           "v 0 0 0 # the first\nv 1 0 0\t# f 1 2 3\nv 1 1 0\nv 0 1 0\nf 1 2 3 4 # all \\\n",
                           "v 0 0 0\nv 1 \\\n0 0\nv 1 1 0\nv 0 1 0\nf 1 2 \\\r\n3 \\\r\n4\r\n",
                           "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nf -4 -3 -2 -1"}) {
    const ClothMesh m = mesh_of(same, "same.obj");
    EXPECT_EQ(m.vertices, plain.vertices) << same;
    EXPECT_EQ(m.triangles, plain.triangles) << same;
  }
  EXPECT_TRUE(mesh_of("g panel#1 #2\nv 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n", "m.obj").groups.contains("panel#1"));
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

TEST(ClothMesh, BadObjIsRefusedNamingFileAndWhat) {
  const auto refused = [](const std::string& text, const char* expected) {
    const std::string message = refusal([&] { mesh_of(text, "mesh.obj"); });
    EXPECT_PRED2(mentions, message, "mesh.obj");
    EXPECT_PRED2(mentions, message, expected) << text;
  };
  // Lines after the three corners of a triangle.
  for (const auto& [lines, expected] : std::vector<std::pair<std::string, const char*>>{
           {"", "expected at least one triangle"},
           {"f 1 2 4\n", "mesh.obj: line 4: vertex 4: expected one of the 3"},
           {"f 1 2 -4\n", "mesh.obj: line 4: vertex -4: expected one of the 3"},
           {"f 0 1 2\n", "mesh.obj: line 4: vertex 0: expected one of the 3"},
           {"f 1 2 3.5\n", "mesh.obj: line 4: \"3.5\": expected the numbers of a vertex"},
           {"f 1 2 4294967299\n", "mesh.obj: line 4: \"4294967299\": expected the numbers"},
           {"f 1 2\n", "mesh.obj: line 4: expected at least three corners"},
           {"f 1 2 2\n", "has no area"},
           {"v 5 5 5\nf 1 2 3\n", "mesh.obj: line 4: vertex 3 (the first is 0) is in no triangle"},
           {"f 1 2 3\nf 3 2 1\n", "mesh.obj: line 5: triangles 0 and 1 have the same vertices"},
           {"v 0 0 1\nv 0 -1 0\nf 1 2 3\nf 1 2 4\nf 1 2 5\n", "more than two triangles"},
           {"v 1 1 0\nf 1 2 3\nf 2 3 4\n",
            "mesh.obj: line 6: triangles 0 and 1 are wound oppositely: both run from vertex 1 to 2"}})
    refused("v 0 0 0\nv 1 0 0\nv 0 1 0\n" + lines, expected);
  refused("", "expected at least one triangle");
  refused("v 0 0 0\r\nv 1 0 0\r\nv 0 1\r\nf 1 2 3\r\n", "mesh.obj: line 3: expected 3 numbers after \"v\"");
  refused("# v\n\nv 0 0 0 # a corner\nv 1 0x1p0 0\nv 0 1 0\nf 1 2 3\n",
          "mesh.obj: line 4: \"0x1p0\": expected a finite decimal");
  refused("v 0 0 0\nv 1 \\\n 0 \\\n 0\nv 0 1 zero\nf 1 2 3\n", "mesh.obj: line 5: \"zero\"");
  refused("#\nv 0 nan 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n", "mesh.obj: line 2: \"nan\": expected a finite decimal number");
  refused("v 1e400 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n", "mesh.obj");
  refused("v 0 0 0\nv 2 2 0\nv 2 0 0\nv 0 1 0\nf \\\n1 2 3 4\n", "mesh.obj: line 5: the outline of the face crosses");
  refused("v 0 0 0\nv 1 0 0\nv 2 0 0\nv 3 0 0\nf 1 2 3 4\n", "mesh.obj: line 5: a face that has no area");
  refused("v 0 0 0\nv 1 0 0\nv 2 0 0\nf 1 2 3\n", "triangle 0 (vertices 0, 1, 2) has no area");
  refused("v 0 0 0\nv 1 0 0\nv 1 0 0\nf 1 2 3\n", "has no area");
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

// Polygons cut into triangles: random ones with fixed seeds, and invalid ones.

using Polygon = std::vector<Vec3>;

/// Half the sum of cross products: the vector area of any surface that the polygon bounds.
Vec3 area_vector(const Polygon& p) {
  Vec3 sum{};
  for (std::size_t k = 0; k < p.size(); ++k)
    sum = plus(sum, cross(minus(p[k], p[0]), minus(p[(k + 1) % p.size()], p[0])));
  return scaled(0.5, sum);
}

class Draw {
 public:
  explicit Draw(unsigned seed) : random_(seed) {}
  double between(double low, double high) {
    return low + (high - low) * (static_cast<double>(random_()) / 4294967296.0);
  }
  std::size_t below(std::size_t n) { return random_() % n; }

  /// A star-shaped polygon, mostly concave, in the plane z = 0.
  Polygon star(std::size_t corners) {
    Polygon p;
    for (std::size_t k = 0; k < corners; ++k) {
      const double angle =
          2 * std::numbers::pi * (static_cast<double>(k) + between(0, 0.9)) / static_cast<double>(corners);
      const double r = between(0.1, 1);
      p.push_back({r * std::cos(angle), r * std::sin(angle), 0});
    }
    return p;
  }

  /// The outline of a row of columns: right angles, and corners in the middle of straight sides.
  Polygon skyline(std::size_t columns) {
    Polygon p = {{0, 0, 0}};
    for (std::size_t k = 0; k < columns; ++k) p.push_back({static_cast<double>(k + 1), 0, 0});
    for (std::size_t k = columns; k > 0; --k) {
      const double height = static_cast<double>(1 + below(4));
      p.push_back({static_cast<double>(k), height, 0});
      p.push_back({static_cast<double>(k) - 0.5, height, 0});
      p.push_back({static_cast<double>(k - 1), height, 0});
    }
    return p;
  }

  /// The polygon rotated, moved, scaled, and starting at a different corner.
  Polygon anywhere(Polygon p) {
    std::rotate(p.begin(), p.begin() + static_cast<std::ptrdiff_t>(below(p.size())), p.end());
    const double a = between(0, 6), b = between(0, 6), size = std::pow(10, between(-3, 3));
    for (Vec3& x : p) {
      x = {std::cos(a) * x[0] - std::sin(a) * x[1], std::sin(a) * x[0] + std::cos(a) * x[1], x[2]};
      x = {x[0], std::cos(b) * x[1] - std::sin(b) * x[2], std::sin(b) * x[1] + std::cos(b) * x[2]};
      x = plus(scaled(size, x), {size, -2 * size, 0.5 * size});
    }
    return p;
  }

  /// Repeats some corners directly after themselves.
  Polygon repeated(const Polygon& p) {
    Polygon out;
    for (const Vec3& x : p)
      for (std::size_t n = 1 + below(2); n > 0; --n) out.push_back(x);
    return out;
  }

 private:
  std::mt19937 random_;
};

/// Checks the number of triangles (distinct corners minus two), their winding and total area, projected along the
/// polygon's axis: as no area is negative, no triangle is outside and none overlaps another.
void expect_cut(const Polygon& p) {
  constexpr double kRounding = 1e-12;
  std::size_t different = 0;
  for (std::size_t k = 0; k < p.size(); ++k) different += p[k] != p[(k + 1) % p.size()] ? 1 : 0;
  const Vec3 normal = area_vector(p);
  std::size_t axis = 0;
  for (std::size_t k = 1; k < 3; ++k)
    if (std::abs(normal[k]) > std::abs(normal[axis])) axis = k;
  const auto triangles = triangulated(p, "a polygon");
  EXPECT_EQ(triangles.size(), different - 2);
  std::set<std::uint32_t> used;
  double sum = 0;
  for (const auto& t : triangles) {
    const Vec3 &a = p.at(t[0]), &b = p.at(t[1]), &c = p.at(t[2]), area = area_vector({a, b, c});
    const double share = area[axis] / normal[axis];
    EXPECT_GT(share, 0);
    EXPECT_GT(length(area) / std::pow(std::max({length(minus(a, b)), length(minus(b, c)), length(minus(c, a))}), 2),
              1e-9)
        << "a cloth would be refused for it";
    sum += share;
    used.insert(t.begin(), t.end());
  }
  EXPECT_EQ(used.size(), different);
  if (!(std::abs(sum - 1) <= kRounding)) ADD_FAILURE() << sum << " of the polygon's area";
}

TEST(Polygon, IsCutInside) {
  for (unsigned seed = 1; seed <= 300; ++seed) {
    SCOPED_TRACE(seed);
    Draw draw(seed);
    const std::size_t corners = 4 + draw.below(40);
    expect_cut(draw.anywhere(draw.star(corners)));
    const std::size_t columns = 1 + draw.below(8);
    expect_cut(draw.skyline(columns));
    expect_cut(draw.anywhere(draw.skyline(columns)));
    Polygon twice = draw.anywhere(draw.star(corners));
    expect_cut(draw.repeated(twice));
    std::reverse(twice.begin(), twice.end());
    expect_cut(twice);
  }
}

TEST(Polygon, NeedNotBeFlat) {
  for (unsigned seed = 1; seed <= 300; ++seed) {
    SCOPED_TRACE(seed);
    Draw draw(seed);
    Polygon p = draw.star(4 + draw.below(12));
    for (Vec3& x : p) x[2] = draw.between(-0.05, 0.05);
    expect_cut(p);
  }
}

TEST(Polygon, ThatIsNoneIsRefused) {
  const auto why = [](const Polygon& p) { return refusal([&] { triangulated(p, "m.obj: line 3"); }); };
  EXPECT_EQ(why({{0, 0, 0}, {1, 1, 1}, {2, 2, 2}, {3, 3, 3}}), "m.obj: line 3: a face that has no area");
  EXPECT_EQ(why({{0, 0, 0}, {1, 0, 0}, {1, 0, 0}}), "m.obj: line 3: a face that has no area");
  EXPECT_EQ(why(Polygon(5, {1, 2, 3})), "m.obj: line 3: a face that has no area");
  const char* crosses = "m.obj: line 3: the outline of the face crosses or touches itself";
  EXPECT_EQ(why({{0, 0, 0}, {2, 2, 0}, {2, 0, 0}, {0, 1, 0}}).find(crosses), 0u) << "a bow tie";
  EXPECT_EQ(why({{0, 0, 0}, {2, 0, 0}, {2, 2, 0}, {1, 0, 0}, {0, 2, 0}}).find(crosses), 0u) << "a corner on a side";
  EXPECT_EQ(why({{0, 0, 0}, {2, 0, 0}, {3, 0, 0}, {2, 0, 0}, {2, 2, 0}}).find(crosses), 0u) << "a spike";
  EXPECT_EQ(why({{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 0, 0}, {-1, 0, 0}, {-1, -1, 0}}).find(crosses), 0u);
  Draw draw(1);
  EXPECT_PRED2(mentions, why(draw.star(kMostCorners + 1)), "1001 corners; expected at most 1000");
  for (unsigned seed = 1; seed <= 300; ++seed) {
    // Two neighbouring corners on a circle are swapped, so the sides before and after them cross.
    Draw other(seed);
    Polygon p = other.star(5 + other.below(20));
    for (Vec3& x : p) x = scaled(1 / length(x), x);
    std::swap(p[2], p[3]);
    EXPECT_EQ(why(other.anywhere(p)).find(crosses), 0u) << seed;
  }
}

// Sheets of irregular triangles, generated from numbers.

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
  EXPECT_NEAR(longest_sides(all).first, 1, 1e-12) << "of one sheet";
  EXPECT_NEAR(longest_sides(all).second, 0.5, 1e-12);
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

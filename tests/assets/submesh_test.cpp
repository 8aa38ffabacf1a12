#include "assets/submesh.hpp"

#include <random>

#include "support.hpp"

namespace clothbench::assets {
namespace {

/// By cutting the triangle back to the box, face by face: another method than separating axes.
bool overlaps_by_clipping(const Box& box, std::vector<Vector> polygon) {
  for (int axis = 0; axis < 3; ++axis)
    for (double sign : {-1.0, 1.0}) {
      const auto beyond = [&](const Vector& p) {
        return sign > 0 ? p[axis] - box.max()[axis] : box.min()[axis] - p[axis];
      };
      std::vector<Vector> kept;
      for (std::size_t i = 0; i < polygon.size(); ++i) {
        const Vector &a = polygon[i], &b = polygon[(i + 1) % polygon.size()];
        const double da = beyond(a), db = beyond(b);
        if (da <= 0) kept.push_back(a);
        if ((da < 0 && db > 0) || (da > 0 && db < 0)) kept.push_back(a + (b - a) * (da / (da - db)));
      }
      polygon = kept;
    }
  return !polygon.empty();
}

TEST(SubMesh, SeparatingAxesAgreeWithClipping) {
  std::mt19937_64 random(7);
  std::uniform_real_distribution<double> place(-2, 2);
  const Box box(Vector(-0.5, -0.3, -0.1), Vector(0.4, 0.6, 0.2));
  int hits = 0, crossing = 0;
  for (int i = 0; i < 20000; ++i) {
    std::array<Vector, 3> p;
    for (Vector& v : p) v = {place(random), place(random), place(random)};
    const bool expected = overlaps_by_clipping(box, {p.begin(), p.end()});
    EXPECT_EQ(overlaps(box, p[0], p[1], p[2]), expected) << i;
    hits += expected;
    crossing += expected && !box.contains(p[0]) && !box.contains(p[1]) && !box.contains(p[2]);
  }
  EXPECT_GT(crossing, 500);
  EXPECT_LT(hits, 15000);
}

TEST(SubMesh, TouchingCounts) {
  const Box box(Vector(0, 0, 0), Vector(1, 1, 1));
  EXPECT_TRUE(overlaps(box, {1, -5, -5}, {1, 5, -5}, {1, 0, 5})) << "in the plane of a face";
  EXPECT_FALSE(overlaps(box, {1.0000001, -5, -5}, {1.0000001, 5, -5}, {1.0000001, 0, 5}));
  EXPECT_TRUE(overlaps(box, {0.2, 0.2, 0.2}, {0.2, 0.2, 0.2}, {0.2, 0.2, 0.2})) << "degenerate, inside";
}

TEST(SubMesh, LargeTriangleIsOnlyInCrossingMode) {
  TriangleMesh mesh{{-10, 0.5, -10, 0, 0.5, 20, 10, 0.5, -10, 0.5, 0.5, 0.5}, {{0, 1, 2}, {0, 1, 3}}};
  const Box box(Vector(0, 0, 0), Vector(1, 1, 1));
  const SubMesh published = cut(mesh, box, CutMode::AnyVertexInside), crossing = cut(mesh, box, CutMode::Crossing);
  EXPECT_EQ(published.source_triangle, (std::vector<std::uint32_t>{1}));
  EXPECT_EQ(published.source_vertex, (std::vector<std::uint32_t>{0, 1, 3}));
  EXPECT_EQ(published.mesh.triangles[0], (std::array<std::uint32_t, 3>{0, 1, 2}));
  EXPECT_EQ(published.crossing_only, 0u);
  EXPECT_EQ(crossing.mesh.triangles.size(), 2u);
  EXPECT_EQ(crossing.crossing_only, 1u);
}

TEST(SubMesh, SixPointsMustBeFinite) {
  std::array<Vector, 6> points;
  points.fill(Vector::Zero());
  points[3].y() = std::numeric_limits<double>::quiet_NaN();
  EXPECT_NE(error_of([&] { box_of(points); }).find("finite"), std::string::npos);
}

struct Desk {
  const char* uuid;
  std::size_t triangles, vertices;
};
class Desks : public testing::TestWithParam<Desk> {};

// Counts for the published rule, from another program (numpy) on @iwer/sem 2.4.0.
TEST_P(Desks, Counts) {
  NEED_NPM_ASSETS(source);
  const Room room = open_room(source, "living_room");
  const Box box = box_of(six_points(find_table(room, GetParam().uuid)));
  EXPECT_NEAR(box.sizes().y(), 0.15, 1e-9);
  const SubMesh published = cut(room.mesh, box, CutMode::AnyVertexInside),
                crossing = cut(room.mesh, box, CutMode::Crossing);
  EXPECT_EQ(published.mesh.triangles.size(), GetParam().triangles);
  EXPECT_EQ(published.mesh.vertex_count(), GetParam().vertices);
  EXPECT_EQ(topology(published.mesh).unused_vertices, 0u);
  EXPECT_EQ(crossing.mesh.triangles.size(), GetParam().triangles + crossing.crossing_only);
  for (std::size_t v = 0; v < published.mesh.vertex_count(); ++v)
    EXPECT_EQ(published.mesh.vertex(v), room.mesh.vertex(published.source_vertex[v]));
  RecordProperty("crossing_only", static_cast<int>(crossing.crossing_only));
}
INSTANTIATE_TEST_SUITE_P(LivingRoom, Desks, testing::Values(Desk{"444c8313", 517, 291}, Desk{"1088a241", 489, 293}),
                         [](const auto& p) { return std::string("t") + p.param.uuid; });

}  // namespace
}  // namespace clothbench::assets

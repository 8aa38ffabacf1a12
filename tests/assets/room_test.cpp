#include "assets/room.hpp"

#include <set>

#include "support.hpp"

namespace clothbench::assets {
namespace {

struct Expected {
  const char* name;
  std::size_t entities, vertices, triangles, zero_area, components;
  double median_edge_m;
};
// Facts of @iwer/sem 2.4.0, measured with another program (numpy).
class Captures : public testing::TestWithParam<Expected> {};

double median_edge(const TriangleMesh& mesh) {
  std::vector<double> lengths;
  for (const auto& t : mesh.triangles)
    for (std::size_t k = 0; k < 3; ++k)
      if (t[k] < t[(k + 1) % 3]) lengths.push_back((mesh.vertex(t[k]) - mesh.vertex(t[(k + 1) % 3])).norm());
  std::nth_element(lengths.begin(), lengths.begin() + static_cast<std::ptrdiff_t>(lengths.size() / 2), lengths.end());
  return lengths[lengths.size() / 2];
}

TEST_P(Captures, LoadsWhole) {
  NEED_NPM_ASSETS(source);
  const Expected e = GetParam();
  const Room room = open_room(source, e.name);
  EXPECT_EQ(room.entities, e.entities);
  EXPECT_EQ(room.mesh.vertex_count(), e.vertices);
  EXPECT_EQ(room.mesh.triangles.size(), e.triangles);
  EXPECT_EQ(room.zero_area_triangles, e.zero_area);
  const Topology t = topology(room.mesh);
  EXPECT_TRUE(t.closed_manifold()) << t.border_edges << " border, " << t.bad_edges << " bad, " << t.split_vertices
                                   << " split";
  EXPECT_EQ(t.components, e.components);
  EXPECT_NEAR(median_edge(room.mesh), e.median_edge_m, 0.001);
  EXPECT_LT(signed_volume(room.mesh), 0) << "normals point into free space";
}

INSTANTIATE_TEST_SUITE_P(All, Captures,
                         testing::Values(Expected{"living_room", 26, 30933, 62102, 11, 12, 0.071},
                                         Expected{"meeting_room", 21, 8328, 16704, 0, 3, 0.085},
                                         Expected{"music_room", 20, 43107, 86786, 11, 8, 0.071},
                                         Expected{"office_large", 38, 11022, 22188, 0, 1, 0.074},
                                         Expected{"office_small", 14, 1895, 3822, 0, 2, 0.092}),
                         [](const auto& p) { return p.param.name; });

TEST(Room, TablesOfTheLivingRoom) {
  NEED_NPM_ASSETS(source);
  const Room room = open_room(source, "living_room");
  ASSERT_EQ(room.tables.size(), 4u);
  std::set<std::string> tops;
  for (const Table& table : room.tables) {
    ASSERT_TRUE(table.top) << table.uuid;
    tops.insert(table.top->uuid);
    EXPECT_NEAR(table.top->frame.translation().y(), table.top_height(), 0.005);
    EXPECT_NEAR((table.frame.linear() * Vector::UnitZ()).y(), 1, 1e-3) << "the box's z is up";
  }
  EXPECT_EQ(tops.size(), 4u);
  const Table& low = find_table(room, "444c8313");
  EXPECT_NEAR(low.top_height(), 0.452, 0.001);
  EXPECT_NEAR(low.box.sizes().x(), 1.12, 0.005);
  EXPECT_NEAR(low.box.sizes().y(), 0.61, 0.005);
  EXPECT_NEAR(find_table(room, "1088a241").top_height(), 0.789, 0.001);
}

TEST(Room, TableTopIsWhereTheScanIs) {
  NEED_NPM_ASSETS(source);
  const Room room = open_room(source, "living_room");
  const Table& table = find_table(room, "444c8313");
  const auto corners = table.top_corners();
  const Vector middle = (corners[0] + corners[2]) / 2;
  // Scanned surface straight above or below the middle, nearest to it.
  double gap = 1;
  for (const auto& t : room.mesh.triangles) {
    const Vector a = room.mesh.vertex(t[0]) - middle, b = room.mesh.vertex(t[1]) - middle,
                 c = room.mesh.vertex(t[2]) - middle;
    const auto twice = [](const Vector& p, const Vector& q) { return p.z() * q.x() - p.x() * q.z(); };
    const double wa = twice(b, c), wb = twice(c, a), wc = twice(a, b);
    if (wa > 0 && wb > 0 && wc > 0)
      gap = std::min(gap, std::abs((wa * a.y() + wb * b.y() + wc * c.y()) / (wa + wb + wc)));
  }
  EXPECT_LT(gap, 0.02) << "facing up, within the scan's noise";
  EXPECT_GT((corners[1] - corners[0]).cross(corners[2] - corners[0]).y(), 0) << "counter-clockwise from above";
}

TEST(Room, FindTableSaysWhatThereIs) {
  NEED_NPM_ASSETS(source);
  const Room room = open_room(source, "living_room");
  const std::string message = error_of([&] { find_table(room, "ffff"); });
  EXPECT_NE(message.find("living_room"), std::string::npos);
  EXPECT_NE(message.find("444c8313-715c-429d-ba72-2b93211fe49f"), std::string::npos) << message;
  EXPECT_NE(error_of([&] { find_table(room, ""); }), "");
}

TEST(Room, UnknownNameSuggestsTheNearest) {
  const std::string message = error_of([] { open_room(AssetSource{}, "livin_room"); });
  EXPECT_NE(message.find("nearest known: living_room"), std::string::npos) << message;
}

}  // namespace
}  // namespace clothbench::assets

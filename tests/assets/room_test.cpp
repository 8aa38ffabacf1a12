#include "assets/room.hpp"

#include "assets/base64.hpp"
#include "assets/mesh.hpp"
#include "support.hpp"

namespace clothbench::assets {
namespace {

TEST(Mesh, TetrahedronIsClosed) {
  TriangleMesh loose = tetrahedron();
  EXPECT_TRUE(is_closed_manifold(loose));
  EXPECT_NEAR(signed_volume(loose), 1.0 / 6, 1e-15);
  loose.add_vertex({2, 2, 2});
  EXPECT_TRUE(is_closed_manifold(loose)) << "a vertex that no triangle uses";
}

TEST(Mesh, DefectsAreSeen) {
  const auto with = [](auto change) {
    TriangleMesh mesh = tetrahedron();
    mesh.add_vertex({2, 2, 2});
    change(mesh.triangles);
    return mesh;
  };
  EXPECT_FALSE(is_closed_manifold(with([](auto& t) { t.pop_back(); }))) << "open";
  EXPECT_FALSE(is_closed_manifold(with([](auto& t) { std::swap(t[0][0], t[0][1]); }))) << "flipped";
  EXPECT_FALSE(is_closed_manifold(with([](auto& t) { t.push_back({0, 1, 4}); }))) << "a fin";
  EXPECT_FALSE(is_closed_manifold(with([](auto& t) { t.push_back({0, 0, 1}); }))) << "an edge without length";
}

TEST(Mesh, TwoBodiesThatShareAVertexAreNoManifold) {
  TriangleMesh pair = tetrahedron();
  for (const Vector& p : {Vector(-1, 0, 0), Vector(0, -1, 0), Vector(0, 0, -1)}) pair.add_vertex(p);
  for (const auto& t : {std::array<std::uint32_t, 3>{0, 4, 5}, {0, 6, 4}, {0, 5, 6}, {4, 6, 5}})
    pair.triangles.push_back(t);
  EXPECT_FALSE(is_closed_manifold(pair));
}

TEST(Base64, BothWays) {
  for (std::size_t n = 0; n < 40; ++n) {
    std::vector<std::uint8_t> bytes;
    for (std::size_t k = 0; k < n; ++k) bytes.push_back(static_cast<std::uint8_t>(37 * k + 11 * n));
    const std::string text = encode_base64(bytes.data(), n);
    EXPECT_EQ(decode_base64(text, "file", "/here"), bytes);
  }
  const std::uint8_t foob[] = {'f', 'o', 'o', 'b'};
  EXPECT_EQ(encode_base64(foob, 4), "Zm9vYg==") << "RFC 4648 section 10";
  for (const char* bad : {"A", "AAA", "AAAAA", "A===", "====", "AA=A", "AB==", "AAB=", "AA\nA", "AA-_", "AA A"})
    EXPECT_THROW(decode_base64(bad, "file", "/here"), Error) << bad;
}

struct Expected {
  const char* name;
  std::size_t vertices, triangles;
};
// Facts of @iwer/sem 2.4.0, measured with another program (numpy).
class Captures : public testing::TestWithParam<Expected> {};

TEST_P(Captures, LoadsWhole) {
  NEED_NPM_ASSETS(source);
  const Expected e = GetParam();
  const Room room = open_room(source, e.name);
  EXPECT_EQ(room.mesh.vertex_count(), e.vertices);
  EXPECT_EQ(room.mesh.triangles.size(), e.triangles);
  EXPECT_TRUE(is_closed_manifold(room.mesh));
  EXPECT_LT(signed_volume(room.mesh), 0) << "normals point into free space";
}

INSTANTIATE_TEST_SUITE_P(All, Captures,
                         testing::Values(Expected{"living_room", 30933, 62102}, Expected{"meeting_room", 8328, 16704},
                                         Expected{"music_room", 43107, 86786}, Expected{"office_large", 11022, 22188},
                                         Expected{"office_small", 1895, 3822}),
                         [](const auto& p) { return p.param.name; });

TEST(Room, TablesOfTheLivingRoom) {
  NEED_NPM_ASSETS(source);
  const Room room = open_room(source, "living_room");
  ASSERT_EQ(room.tables.size(), 4u);
  for (const Table& table : room.tables) {
    EXPECT_NEAR((table.frame.linear() * Vector::UnitZ()).y(), 1, 1e-3) << "the box's z is up";
    const auto c = table.top_corners();
    EXPECT_GT((c[1] - c[0]).cross(c[2] - c[0]).y(), 0) << "counter-clockwise from above";
  }
  const Table& low = find_table(room, "444c8313");
  EXPECT_NEAR(low.top_height(), 0.452, 0.001);
  EXPECT_NEAR(low.box.sizes().x(), 1.12, 0.005);
  EXPECT_NEAR(low.box.sizes().y(), 0.61, 0.005);
  EXPECT_NEAR(find_table(room, "1088a241").top_height(), 0.789, 0.001);
}

TEST(Room, FindTableSaysWhatThereIs) {
  NEED_NPM_ASSETS(source);
  const Room room = open_room(source, "living_room");
  const std::string message = error_of([&] { find_table(room, "ffff"); });
  EXPECT_NE(message.find("living_room"), std::string::npos);
  EXPECT_NE(message.find("444c8313-715c-429d-ba72-2b93211fe49f"), std::string::npos) << message;
  EXPECT_NE(error_of([&] { find_table(room, ""); }), "");
}

TEST(Room, TheCutTakesTrianglesWithAVertexInTheBox) {
  const TriangleMesh mesh{{-10, 0.5, -10, 0, 0.5, 20, 10, 0.5, -10, 0.5, 0.5, 0.5}, {{0, 1, 2}, {0, 1, 3}}};
  const TriangleMesh part = cut(mesh, Box(Vector(0, 0, 0), Vector(1, 1, 1)));
  EXPECT_EQ(part.triangles, (std::vector<std::array<std::uint32_t, 3>>{{0, 1, 2}})) << "not the one that only crosses";
  EXPECT_EQ(part.vertex(2), Vector(0.5, 0.5, 0.5));
}

// Counts from another program (numpy) on @iwer/sem 2.4.0.
TEST(Room, DesksOfTheLivingRoom) {
  NEED_NPM_ASSETS(source);
  const Room room = open_room(source, "living_room");
  struct Desk {
    const char* uuid;
    std::size_t triangles, vertices;
  };
  for (const Desk& desk : {Desk{"444c8313", 517, 291}, {"1088a241", 489, 293}}) {
    const Box box = box_around(find_table(room, desk.uuid));
    EXPECT_NEAR(box.sizes().y(), 0.15, 1e-9);
    const TriangleMesh part = cut(room.mesh, box);
    EXPECT_EQ(part.triangles.size(), desk.triangles);
    EXPECT_EQ(part.vertex_count(), desk.vertices);
  }
}

TEST(Room, UnknownNameSuggestsTheNearest) {
  const std::string message = error_of([] { open_room(AssetSource{}, "livin_room"); });
  EXPECT_NE(message.find("nearest known: living_room"), std::string::npos) << message;
}

}  // namespace
}  // namespace clothbench::assets

#include "assets/mesh.hpp"

#include "assets/json_at.hpp"
#include "support.hpp"

namespace clothbench::assets {
namespace {

TEST(Mesh, TetrahedronIsClosed) {
  const Topology t = topology(tetrahedron());
  EXPECT_TRUE(t.closed_manifold());
  EXPECT_EQ(t.edges, 6u);
  EXPECT_EQ(t.euler, 2);
  EXPECT_EQ(t.components, 1u);
  EXPECT_NEAR(signed_volume(tetrahedron()), 1.0 / 6, 1e-15);
}

TEST(Mesh, DefectsAreSeen) {
  TriangleMesh open = tetrahedron();
  open.triangles.pop_back();
  EXPECT_EQ(topology(open).border_edges, 3u);
  TriangleMesh flipped = tetrahedron();
  std::swap(flipped.triangles[0][0], flipped.triangles[0][1]);
  EXPECT_EQ(topology(flipped).bad_edges, 3u);
  TriangleMesh finned = tetrahedron();
  finned.add_vertex({2, 2, 2});
  finned.triangles.push_back({0, 1, 4});
  EXPECT_EQ(topology(finned).bad_edges, 1u);
  TriangleMesh loose = tetrahedron();
  loose.add_vertex({2, 2, 2});
  EXPECT_EQ(topology(loose).unused_vertices, 1u);
  EXPECT_TRUE(topology(loose).closed_manifold());
}

TEST(Mesh, TwoBodiesThatShareAVertexAreNoManifold) {
  TriangleMesh pair = tetrahedron();
  for (const Vector& p : {Vector(-1, 0, 0), Vector(0, -1, 0), Vector(0, 0, -1)}) pair.add_vertex(p);
  for (const auto& t : {std::array<std::uint32_t, 3>{0, 4, 5}, {0, 6, 4}, {0, 5, 6}, {4, 6, 5}})
    pair.triangles.push_back(t);
  const Topology t = topology(pair);
  EXPECT_EQ(t.border_edges, 0u);
  EXPECT_EQ(t.split_vertices, 1u);
  EXPECT_FALSE(t.closed_manifold());
}

TEST(Mesh, EmptyIsNothing) { EXPECT_EQ(topology(TriangleMesh{}).edges, 0u); }

TEST(Base64, RefusesWhatIsNot) {
  std::vector<std::uint8_t> bytes;
  std::string problem;
  for (const char* bad : {"A", "AAA", "AAAAA", "A===", "====", "AA=A", "AB==", "AAB=", "AA\nA", "AA-_", "AA A"})
    EXPECT_FALSE(decode_base64(bad, bytes, problem)) << bad;
}

}  // namespace
}  // namespace clothbench::assets

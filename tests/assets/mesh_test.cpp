#include "assets/mesh.hpp"

#include "assets/json_at.hpp"
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
    const nlohmann::json text = encode_base64(bytes.data(), n);
    EXPECT_EQ(JsonAt(text, "file").bytes(), bytes);
  }
  const std::uint8_t foob[] = {'f', 'o', 'o', 'b'};
  EXPECT_EQ(encode_base64(foob, 4), "Zm9vYg==") << "RFC 4648 section 10";
  for (const nlohmann::json bad :
       {"A", "AAA", "AAAAA", "A===", "====", "AA=A", "AB==", "AAB=", "AA\nA", "AA-_", "AA A"})
    EXPECT_THROW(JsonAt(bad, "file").bytes(), Error) << bad;
}

}  // namespace
}  // namespace clothbench::assets

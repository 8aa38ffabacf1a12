#include "assets/procedural.hpp"

#include "assets/submesh.hpp"
#include "support.hpp"

namespace clothbench::assets {
namespace {

TEST(ProceduralRoom, IsAClosedManifoldSeenFromWithin) {
  const Room room = procedural_room();
  const Topology t = topology(room.mesh);
  EXPECT_TRUE(t.closed_manifold()) << t.border_edges << " border, " << t.bad_edges << " bad, " << t.split_vertices
                                   << " split";
  EXPECT_EQ(t.components, 1u);
  EXPECT_EQ(t.unused_vertices, 0u);
  // A sphere with a handle for each pair of legs that makes a loop: 3 a table, 2 tables.
  EXPECT_EQ(t.euler, 2 - 2 * 6);
  EXPECT_EQ(room.zero_area_triangles, 0u);
  const double tables = 0.04 * (0.6 * 1.1 + 0.75 * 1.3) + 4 * 0.05 * 0.05 * (0.41 + 0.72);
  EXPECT_NEAR(signed_volume(room.mesh), -(5 * 2.5 * 4 - tables), 0.005);
}

TEST(ProceduralRoom, TablesStandForTheScannedOnes) {
  const Room room = open_room(AssetSource{}, "living_room");
  for (const char* uuid : {"444c8313", "444c8313-715c-429d-ba72-2b93211fe49f", "1088a241"}) {
    const Table& table = find_table(room, uuid);
    const SubMesh desk = cut(room.mesh, box_of(six_points(table)), CutMode::Crossing);
    EXPECT_GT(desk.mesh.triangles.size(), 500u) << uuid;
    double sum = 0, squares = 0, most = 0;
    std::size_t count = 0;
    for (std::size_t v = 0; v < desk.mesh.vertex_count(); ++v) {
      const double above = desk.mesh.vertex(v).y() - table.top_height();
      if (above < -0.02) continue;
      sum += above, squares += above * above, ++count;
      most = std::max(most, std::abs(above));
    }
    const double n = static_cast<double>(count);
    EXPECT_NEAR(std::sqrt(squares / n - sum / n * (sum / n)), 0.005, 0.002) << "as rough as a scan";
    EXPECT_LT(most, 0.015);
  }
}

TEST(ProceduralRoom, IsTheSameEveryTime) {
  EXPECT_EQ(procedural_room().mesh.positions, procedural_room().mesh.positions);
}

TEST(ProceduralHand, TubesAreClosedInEveryPose) {
  for (Side side : {Side::Left, Side::Right}) {
    const Hand hand = procedural_hand(side);
    const Topology t = topology(hand.mesh.rest);
    EXPECT_TRUE(t.closed_manifold());
    EXPECT_EQ(t.components, 5u);
    EXPECT_EQ(t.euler, 10);
    EXPECT_EQ(t.unused_vertices, 0u);
    for (auto name : kPoseNames) {
      TriangleMesh posed = hand.mesh.rest;
      posed.positions = skinned(hand.mesh, hand.pose(std::string(name)).joints);
      EXPECT_GT(signed_volume(posed), 150e-6) << "outward normals, " << name;
      EXPECT_LT(signed_volume(posed), 500e-6) << name;
    }
  }
}

TEST(ProceduralHand, RestIsRelaxed) {
  const Hand hand = procedural_hand(Side::Left);
  const auto positions = skinned(hand.mesh, hand.pose("relaxed").joints);
  for (std::size_t i = 0; i < positions.size(); ++i) ASSERT_NEAR(positions[i], hand.mesh.rest.positions[i], 1e-6 * 0.2);
}

TEST(ProceduralHand, PinchMeetsAndMetacarpalsMakeAPalm) {
  const HandPose pinch = procedural_hand(Side::Right).pose("pinch");
  EXPECT_LT((pinch.joints[kThumb + 3].translation() - pinch.joints[kIndex + 4].translation()).norm(), 0.003);
  const auto c = capsules(pinch);
  for (std::size_t i = 0; i + 1 < 4; ++i)
    EXPECT_LT((c[i].b - c[i + 1].b).norm(), c[i].radius_m + c[i + 1].radius_m) << i;
}

TEST(Assets, ProceduralOnRequest) {
  const char* before = std::getenv("CLOTHBENCH_ASSETS");
  const std::string kept = before ? before : "";
  setenv("CLOTHBENCH_ASSETS", "procedural", 1);
  const AssetSource source = locate_assets(false);
  EXPECT_STREQ(source.kind(), "procedural");
  EXPECT_NE(error_of([] { locate_assets(true); }).find("required"), std::string::npos);
  setenv("CLOTHBENCH_ASSETS", "/nonexistent", 1);
  EXPECT_NE(error_of([] { locate_assets(false); }).find("/nonexistent"), std::string::npos);
  if (before)
    setenv("CLOTHBENCH_ASSETS", kept.c_str(), 1);
  else
    unsetenv("CLOTHBENCH_ASSETS");
}

TEST(Assets, VersionsAreNamed) {
  NEED_NPM_ASSETS(source);
  EXPECT_STREQ(source.kind(), "npm");
  EXPECT_EQ(source.reason, "@iwer/sem 2.4.0, iwer 2.5.0, @webxr-input-profiles/assets 1.0.20");
}

}  // namespace
}  // namespace clothbench::assets

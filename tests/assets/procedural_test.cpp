#include "assets/procedural.hpp"

#include "support.hpp"

namespace clothbench::assets {
namespace {

TEST(ProceduralRoom, IsAClosedManifoldSeenFromWithin) {
  const Room room = procedural_room();
  EXPECT_TRUE(is_closed_manifold(room.mesh));
  const double tables = 0.04 * (0.6 * 1.1 + 0.75 * 1.3) + 4 * 0.05 * 0.05 * (0.41 + 0.72);
  EXPECT_NEAR(signed_volume(room.mesh), -(5 * 2.5 * 4 - tables), 0.005);
}

TEST(ProceduralRoom, TablesStandForTheScannedOnes) {
  const Room room = open_room(AssetSource{}, "living_room");
  for (const char* uuid : {"444c8313", "444c8313-715c-429d-ba72-2b93211fe49f", "1088a241"}) {
    const Table& table = find_table(room, uuid);
    const TriangleMesh desk = cut(room.mesh, box_around(table));
    EXPECT_GT(desk.triangles.size(), 500u) << uuid;
    double sum = 0, squares = 0, most = 0;
    std::size_t count = 0;
    for (std::size_t v = 0; v < desk.vertex_count(); ++v) {
      const double above = desk.vertex(v).y() - table.top_height();
      if (above < -0.02) continue;
      sum += above, squares += above * above, ++count;
      most = std::max(most, std::abs(above));
    }
    const double n = static_cast<double>(count);
    EXPECT_NEAR(std::sqrt(squares / n - sum / n * (sum / n)), 0.005, 0.002) << "as rough as a scan";
    EXPECT_LT(most, 0.015);
  }
}

TEST(ProceduralHand, TubesAreClosedInEveryPose) {
  for (Side side : {Side::Left, Side::Right}) {
    const Hand hand = procedural_hand(side);
    EXPECT_TRUE(is_closed_manifold(hand.mesh.rest));
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
  const char* set = std::getenv("CLOTHBENCH_ASSETS");
  const std::optional<std::string> before = set != nullptr ? std::optional<std::string>(set) : std::nullopt;
  setenv("CLOTHBENCH_ASSETS", "procedural", 1);
  const AssetSource source = locate_assets(false);
  EXPECT_STREQ(source.kind(), "procedural");
  EXPECT_NE(error_of([] { locate_assets(true); }).find("required"), std::string::npos);
  setenv("CLOTHBENCH_ASSETS", "/nonexistent", 1);
  EXPECT_NE(error_of([] { locate_assets(false); }).find("/nonexistent"), std::string::npos);
  before ? setenv("CLOTHBENCH_ASSETS", before->c_str(), 1) : unsetenv("CLOTHBENCH_ASSETS");
}

TEST(Assets, VersionsAreNamed) {
  NEED_NPM_ASSETS(source);
  EXPECT_STREQ(source.kind(), "npm");
  EXPECT_EQ(source.reason, "@iwer/sem 2.4.0, iwer 2.5.0, @webxr-input-profiles/assets 1.0.20");
}

}  // namespace
}  // namespace clothbench::assets

#include "assets/hand.hpp"

#include <algorithm>
#include <numeric>
#include <tuple>

#include "assets/assets.hpp"
#include "base/interval.hpp"
#include "support.hpp"
#include "with_folder.hpp"

namespace clothbench::assets {
namespace {

class Hands : public testing::TestWithParam<Side> {};

double volume_of(const Hand& hand, const HandPose& pose) {
  TriangleMesh posed = hand.mesh.rest;
  posed.positions = skinned(hand, pose.joints);
  return signed_volume(posed);
}

TEST_P(Hands, MeshIsOneClosedSurface) {
  NEED_NPM_ASSETS(source);
  const Hand hand = open_hand(source, GetParam());
  EXPECT_EQ(hand.mesh.rest.vertex_count(), 1159u);
  EXPECT_EQ(hand.mesh.rest.triangles.size(), 2314u);
  EXPECT_TRUE(is_closed_manifold(hand.mesh.rest));
  EXPECT_NEAR(signed_volume(hand.mesh.rest), 343e-6, 2e-6);
}

TEST_P(Hands, SkinningFollowsARigidMotion) {
  NEED_NPM_ASSETS(source);
  const Hand hand = open_hand(source, GetParam());
  Frame by = Frame::Identity();
  by.rotate(Eigen::AngleAxisd(0.7, Vector(1, 2, 3).normalized())).pretranslate(Vector(0.4, -0.5, 0.6));
  const HandPose& pose = hand.pose("pinch");
  const auto before = skinned(hand, pose.joints), after = skinned(hand, moved(pose, by).joints);
  double worst = 0;
  for (std::size_t i = 0; i < before.size(); i += 3)
    worst = std::max(worst, (by * Vector::Map(&before[i]) - Vector::Map(&after[i])).norm());
  EXPECT_LT(worst, 1e-6 * 0.2);
}

// Volumes in cm^3, computed by a numpy program without welding or palm frame, for iwer 2.5.0 and WebXR assets 1.0.20.
// Linear blend skinning loses volume at bent joints.
TEST_P(Hands, VolumeOfPoses) {
  NEED_NPM_ASSETS(source);
  const Hand hand = open_hand(source, GetParam());
  const bool left = GetParam() == Side::Left;
  EXPECT_NEAR(1e6 * volume_of(hand, hand.pose("relaxed")), left ? 353.007 : 361.529, 0.01);
  EXPECT_NEAR(1e6 * volume_of(hand, hand.pose("pinch")), left ? 334.474 : 341.393, 0.01);
  EXPECT_NEAR(1e6 * volume_of(hand, hand.pose("point")), left ? 338.845 : 347.772, 0.01);
}

TEST_P(Hands, PalmFrameAndPinch) {
  NEED_NPM_ASSETS(source);
  const Hand hand = open_hand(source, GetParam());
  for (auto name : kPoseNames) {
    const HandPose& pose = hand.pose(std::string(name));
    EXPECT_LT((palm_frame(pose).matrix() - Eigen::Matrix4d::Identity()).cwiseAbs().maxCoeff(), 1e-9);
    EXPECT_LT(pose.joints[kWrist].translation().y(), -0.05) << "fingers point to +y";
    const double thumb_x = pose.joints[kThumb].translation().x();
    EXPECT_TRUE(GetParam() == Side::Right ? thumb_x < 0 : thumb_x > 0);
  }
  const JointFrames& pinch = hand.pose("pinch").joints;
  EXPECT_LT((pinch[kThumb + 3].translation() - pinch[kIndex + 4].translation()).norm(), 0.005) << "thumb meets finger";
  EXPECT_GT(hand.pose("relaxed").joints[kMiddle + 4].translation().y(), 0.1);
  EXPECT_LT(hand.pose("point").joints[kMiddle + 1 + 1].translation().z(), -0.03) << "fingers bend to the palm, -z";
}

INSTANTIATE_TEST_SUITE_P(Both, Hands, testing::Values(Side::Left, Side::Right),
                         [](const auto& p) { return std::string(name_of(p.param)); });

TEST(Capsules, RadiiAndLengths) {
  NEED_NPM_ASSETS(source);
  const auto found = capsules(open_hand(source, Side::Right).pose("relaxed"));
  // iwer 2.5.0, millimetres, in the order of the documentation: palm, thumb, index, middle, ring, little finger.
  const std::array<double, kCapsuleCount> radius_mm = {21.2, 21.2, 19.1, 18.1, 19.4, 12.3, 9.8, 10.3, 8.5, 7.6,
                                                       11.2, 8.0,  7.6,  9.9,  7.6,  7.2,  8.5, 6.8,  6.4};
  for (std::size_t i = 0; i < kCapsuleCount; ++i) EXPECT_NEAR(1000 * found[i].radius_m, radius_mm[i], 0.051) << i;
  for (std::size_t i : {6u, 9u, 12u, 15u, 18u}) EXPECT_NEAR((found[i].b - found[i].a).norm(), 0.015, 1e-12) << i;
  for (std::size_t i : {4u, 5u, 7u, 8u, 10u, 11u, 13u, 14u, 16u, 17u})
    EXPECT_EQ(found[i].b, found[i + 1].a) << "bones of a finger are joined, " << i;
  // Bone lengths of the headset's own hand, millimetres.
  EXPECT_NEAR(1000 * (found[4].b - found[4].a).norm(), 32.5, 0.6);
  EXPECT_NEAR(1000 * (found[8].b - found[8].a).norm(), 24.3, 0.6);
}

/// Distances from another program (numpy, on the files of iwer 2.5.0 and assets 1.0.20), in millimetres.
TEST(Capsules, LieCloseToTheSkinOfTheRecordedPoses) {
  NEED_NPM_ASSETS(source);
  const Hand hand = open_hand(source, Side::Left);
  for (const auto& [name, mean_mm, p95_mm] :
       {std::tuple{"relaxed", 2.50, 7.53}, std::tuple{"pinch", 2.61, 8.32}, std::tuple{"point", 2.93, 8.21}}) {
    const HandPose& pose = hand.pose(name);
    const std::vector<double> x = skinned(hand, pose.joints);
    std::vector<double> distance_mm;
    for (std::size_t v = 0; v < hand.mesh.rest.vertex_count(); ++v) {
      double of_wrist = 0, nearest = 1;
      for (std::size_t k = 0; k < 4; ++k)
        if (hand.mesh.joints[v][k] == kWrist) of_wrist += hand.mesh.weights[v][k];
      if (of_wrist >= 0.5) continue;
      for (const Capsule& c : capsules(pose)) {
        const Vector from_a = Vector::Map(&x[3 * v]) - c.a, axis = c.b - c.a;
        const double t = std::clamp(from_a.dot(axis) / axis.squaredNorm(), 0.0, 1.0);
        nearest = std::min(nearest, (from_a - t * axis).norm() - c.radius_m);
      }
      distance_mm.push_back(1000 * std::abs(nearest));
    }
    const double count = static_cast<double>(distance_mm.size());
    EXPECT_EQ(count, 1043) << name;
    EXPECT_NEAR(std::accumulate(distance_mm.begin(), distance_mm.end(), 0.0) / count, mean_mm, 0.01) << name;
    EXPECT_NEAR(quantile(distance_mm, 0.95), p95_mm, 0.01) << name;
  }
}

TEST(Capsules, DistalOneEndsAtANearerTip) {
  const AssetSource procedural;
  HandPose pose = open_hand(procedural, Side::Right).pose("relaxed");
  const Vector distal = pose.joints[kIndex + 3].translation();
  pose.joints[kIndex + 4].translation() = distal + Vector(0, 0.004, 0);
  EXPECT_EQ(capsules(pose)[9].b, Vector(distal + Vector(0, 0.004, 0)));
}

TEST(Pose, MirroredTwiceIsTheSame) {
  const HandPose pose = open_hand(AssetSource{}, Side::Right).pose("point"), twice = mirrored(mirrored(pose));
  for (std::size_t j = 0; j < kJointCount; ++j) EXPECT_EQ(pose.joints[j].matrix(), twice.joints[j].matrix());
  for (const Frame& joint : mirrored(pose).joints) EXPECT_NEAR(joint.linear().determinant(), 1, 1e-12);
}

TEST(Pose, BlendIsHalfWay) {
  const Hand hand = open_hand(AssetSource{}, Side::Right);
  const HandPose &a = hand.pose("relaxed"), &b = hand.pose("pinch"), half = blended(a, b, 0.5);
  for (std::size_t j = 0; j < kJointCount; ++j) {
    EXPECT_LT((half.joints[j].translation() - (a.joints[j].translation() + b.joints[j].translation()) / 2).norm(),
              1e-12);
    const Eigen::Quaterniond qa(a.joints[j].linear()), qb(b.joints[j].linear()), qh(half.joints[j].linear());
    EXPECT_NEAR(qa.angularDistance(qh), qa.angularDistance(qb) / 2, 1e-7);
    EXPECT_NEAR(qb.angularDistance(qh), qa.angularDistance(qb) / 2, 1e-7);
  }
  EXPECT_NE(error_of([&] { hand.pose("relaxd"); }).find("nearest known: relaxed"), std::string::npos);
}

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
      posed.positions = skinned(hand, hand.pose(std::string(name)).joints);
      EXPECT_GT(signed_volume(posed), 150e-6) << "outward normals, " << name;
      EXPECT_LT(signed_volume(posed), 500e-6) << name;
    }
  }
}

TEST(ProceduralHand, RestIsRelaxed) {
  const Hand hand = procedural_hand(Side::Left);
  const auto positions = skinned(hand, hand.pose("relaxed").joints);
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
  const Variable procedural("CLOTHBENCH_ASSETS", "procedural");
  const AssetSource source = locate_assets(false);
  EXPECT_STREQ(source.kind(), "procedural");
  EXPECT_NE(error_of([] { locate_assets(true); }).find("required"), std::string::npos);
  const Variable nowhere("CLOTHBENCH_ASSETS", "/nonexistent");
  EXPECT_NE(error_of([] { locate_assets(false); }).find("/nonexistent"), std::string::npos);
}

TEST(Assets, VersionsAreNamed) {
  NEED_NPM_ASSETS(source);
  EXPECT_STREQ(source.kind(), "npm");
  EXPECT_EQ(source.reason, "@iwer/sem 2.4.0, iwer 2.5.0, @webxr-input-profiles/assets 1.0.20");
}

}  // namespace
}  // namespace clothbench::assets

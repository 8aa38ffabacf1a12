#include <cmath>

#include "assets/hand_recording.hpp"
#include "null_runtime/script.hpp"
#include "sessions.hpp"

namespace clothbench::xr {
namespace {

constexpr double kFloat_m = 1e-6;  // places within 2 m in float32
const Vec3 kPlace_m = {0, -0.1, -0.6};

/// Script's time of a frame, by where the palm is.
double time_of(const assets::RecordedHand& hand, bool right) {
  const double x = static_cast<double>(hand.joints[0].position_m[0]) + kPlace_m[0];
  return (0.3 - (right ? x : -x)) / 0.6;
}

template <class Place>
void expect_at(const Place& found, const null_xr::V& expected, const char* what) {
  EXPECT_NEAR(static_cast<double>(found[0]) + kPlace_m[0], expected.x, kFloat_m) << what;
  EXPECT_NEAR(static_cast<double>(found[1]) + kPlace_m[1], expected.y, kFloat_m) << what;
  EXPECT_NEAR(static_cast<double>(found[2]) + kPlace_m[2], expected.z, kFloat_m) << what;
}

double furthest(const std::vector<double>& a, const std::vector<double>& b) {
  double most = 0;
  for (std::size_t k = 0; k < a.size(); ++k) most = std::max(most, std::abs(a[k] - b[k]));
  return most;
}

std::string why_of(const LoopResult& r) {
  return parse_json(read_text(r.scenario.parent_path() / "right-hand.json"), "right-hand.json")["why"];
}

TEST_F(Sessions, CapsulesOfTheRuntimeReachTheSolver) {
  const LoopOptions o = options("paper/capsule-sweep", 50);
  const LoopResult r = run(o, "blind=1");
  const assets::HandRecording hand = assets::read_hand_recording(r.scenario.parent_path() / "right-hand.json");
  EXPECT_TRUE(hand.has_capsules);
  EXPECT_NE(why_of(r).find("Capsules come from XR_FB_hand_tracking_capsules"), std::string::npos) << why_of(r);
  ASSERT_EQ(hand.frames.size(), 51u);
  const double first = time_of(hand.frames[0], true);
  const auto joints = null_xr::joints(true);
  const auto ends = null_xr::capsule_joints();
  const Scene scene = load_scene(r.scenario.string());
  ASSERT_EQ(scene.motion.size(), 51u);
  for (std::size_t k = 0; k < hand.frames.size(); ++k) {
    // The scene is begun a frame before its first step.
    const double t = first + static_cast<double>(k) / 72;
    const null_xr::V palm = null_xr::palm_at(true, t);
    expect_at(hand.frames[k].joints[0].position_m, palm, "palm");
    expect_at(hand.frames[k].joints[25].position_m, palm + joints[25], "tip of the little finger");
    const auto& capsules = scene.motion[k].colliders.at(0).capsules;
    ASSERT_EQ(capsules.size(), 19u);
    for (std::size_t c = 0; c < capsules.size(); ++c) {
      EXPECT_NEAR(capsules[c].radius_m, null_xr::kCapsuleRadius_m, 1e-9);
      expect_at(capsules[c].a_m, palm + joints[static_cast<std::size_t>(ends[c][0])], "a capsule's end");
    }
  }
  EXPECT_EQ(replayed(r, o), r.final_position_m) << "bit for bit";
  LoopOptions alone = o;
  alone.scenario = "paper/gravity";
  alone.overrides = {"cloth.grid=[12,12]", "pins=[{\"edge\":\"v0\"}]",
                     "cloth.pose={\"center_m\":[0,0,0],\"axis_u\":[1,0,0],\"axis_v\":[0,-1,0]}"};
  alone.out = dir_ / "alone";
  EXPECT_GT(furthest(run(alone, "blind=1").final_position_m, r.final_position_m), 0.02)
      << "the hand has pushed the cloth";
}

TEST_F(Sessions, WithoutThemCapsulesAreMadeOfJointsAndRadii) {
  const LoopOptions o = options("paper/capsule-sweep", 20);
  const LoopResult r = run(o, "blind=1,capsules=0");
  const assets::HandRecording hand = assets::read_hand_recording(r.scenario.parent_path() / "right-hand.json");
  EXPECT_FALSE(hand.has_capsules);
  EXPECT_NE(why_of(r).find("Capsules come from XR_EXT_hand_tracking's joints"), std::string::npos) << why_of(r);
  const Scene scene = load_scene(r.scenario.string());
  for (const Capsule& c : scene.motion.back().colliders.at(0).capsules)
    EXPECT_NEAR(c.radius_m, null_xr::kJointRadius_m, 1e-9);
  EXPECT_EQ(replayed(r, o), r.final_position_m);
}

TEST_F(Sessions, AHandMeshFollowsTheJoints) {
  LoopOptions o = options("paper/hand-push", 20);
  o.device.validation = true;
  const LoopResult r = run(o, "");
  const Scene scene = load_scene(r.scenario.string());
  EXPECT_EQ(scene.colliders.at(0).mesh->joint_count, assets::kJointCount);
  EXPECT_EQ(scene.assets, "procedural");
  EXPECT_EQ(replayed(r, o), r.final_position_m);
}

TEST_F(Sessions, AHandOutOfSightStaysWhereItWas) {
  const LoopOptions o = options("paper/capsule-sweep", 40);
  const LoopResult r = run(o, "blind=1,unseen=20:28");
  const assets::HandRecording hand = assets::read_hand_recording(r.scenario.parent_path() / "right-hand.json");
  int unseen = 0;
  for (std::size_t k = 0; k < r.log.rows().size(); ++k) {
    const bool stood = hand.frames[k + 1].joints[0].position_m == hand.frames[k].joints[0].position_m;
    unseen += r.log.rows()[k].right_seen == 0 ? 1 : 0;
    EXPECT_EQ(stood, r.log.rows()[k].right_seen == 0) << k;
  }
  EXPECT_EQ(unseen, 8);
  EXPECT_EQ(replayed(r, o), r.final_position_m);
}

TEST_F(Sessions, BothHandsAndWhatStaysScripted) {
  LoopOptions o = options("paper/capsule-sweep", 16);
  o.overrides.push_back(
      "colliders=[{\"type\":\"hand_capsules\",\"track\":\"assets/right-hand-sweep.json\"},"
      "{\"type\":\"hand_mesh\",\"track\":\"assets/left-hand-stretch-2mps.json\"},"
      "{\"type\":\"capsule\",\"center_m\":[0,-0.4,0.3],\"radius_m\":0.05,\"velocity_m_per_s\":[0,0,-2]}]");
  const LoopResult r = run(o, "blind=1");
  for (const FrameRow& row : r.log.rows()) EXPECT_EQ(row.left_seen + row.right_seen, 2);
  const Scene scene = load_scene(r.scenario.string());
  EXPECT_NEAR(scene.motion[9].colliders.at(2).capsules.at(0).a_m[2], 0.3 - 2 * 9 / 72.0, 1e-9);
  EXPECT_EQ(replayed(r, o), r.final_position_m);
}

}  // namespace
}  // namespace clothbench::xr

#include <cmath>

#include "assets/hand_track.hpp"
#include "null_runtime/script.hpp"
#include "refusal.hpp"
#include "sessions.hpp"
#include "xr/session.hpp"

namespace clothbench::xr {
namespace {

constexpr double kFloat_m = 1e-6;  // float32 rounding of coordinates below 2 m
const Vec3 kPlace_m = {0, -0.1, -0.6};

/// The script's time of a frame, from the palm's position.
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

assets::HandRecording recording_of(const std::filesystem::path& file) {
  return assets::parse_hand_recording(read_text(file), file.string());
}

std::string why_of(const LoopResult& r) {
  return parse_json(read_text(r.scenario.parent_path() / "right-hand.json"), "right-hand.json")["why"];
}

TEST_F(Sessions, CapsulesOfTheRuntimeReachTheSolver) {
  const LoopOptions o = options("paper/capsule-sweep", 50);
  const LoopResult r = run(o, "blind=1");
  const assets::HandRecording hand = recording_of(r.scenario.parent_path() / "right-hand.json");
  EXPECT_TRUE(hand.has_capsules);
  EXPECT_NE(why_of(r).find("Capsules come from XR_FB_hand_tracking_capsules"), std::string::npos) << why_of(r);
  ASSERT_EQ(hand.frames.size(), 51u);
  const double first = time_of(hand.frames[0], true);
  const auto joints = null_xr::joints(true);
  const auto ends = null_xr::capsule_joints();
  const Scene scene = load_scene(r.scenario.string());
  ASSERT_EQ(scene.motion.size(), 51u);
  for (std::size_t k = 0; k < hand.frames.size(); ++k) {
    // The scene begins one frame before its first step.
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
  const assets::HandRecording hand = recording_of(r.scenario.parent_path() / "right-hand.json");
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
  const assets::HandRecording hand = recording_of(r.scenario.parent_path() / "right-hand.json");
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

TEST_F(Sessions, StepsAndShowsEveryFrame) {
  LoopOptions o = options("paper/capsule-sweep", 30);
  o.device.validation = true;
  const LoopResult r = run(o, "look=25");
  ASSERT_EQ(r.log.rows().size(), 30u);
  EXPECT_EQ(reported_["android"], false);
  EXPECT_EQ(reported_["rate_hz"], 72.0) << "asked for, where the display began with 90";
  EXPECT_GE(reported_["frames"].get<int>(), 30);
  EXPECT_GE(reported_["projection_frames"].get<int>(), 30);
  for (const auto& share : reported_["drawn"]) {
    EXPECT_GT(share.get<double>(), 0.05) << "the cloth is seen";
    EXPECT_LT(share.get<double>(), 0.9) << "and the room beside it";
  }
  const std::vector<double> periods = r.log.periods();
  EXPECT_TRUE(std::isnan(periods[0]));
  for (std::size_t k = 0; k < r.log.rows().size(); ++k) {
    const FrameRow& row = r.log.rows()[k];
    if (k > 0) {
      EXPECT_EQ(periods[k], 1) << k;
      EXPECT_GT(row.paint_device_s, 0) << k;
    }
    EXPECT_NEAR(row.predicted_period_s, 1 / 72.0, 1e-9);
    EXPECT_NEAR(row.predicted_display_s, static_cast<double>(k) * row.predicted_period_s, 1e-9);
    EXPECT_GE(row.frame_s, r.log.trial().frame_wall_s.at(k));
    EXPECT_EQ(row.right_seen, 1);
    EXPECT_TRUE(std::isnan(row.left_seen)) << "the scene has no left hand";
  }
  EXPECT_NEAR(r.summary.at("xr_fps_median"), 72, 1e-4);
  EXPECT_EQ(r.summary.at("xr_late_frames"), 0);
  for (const StoredArray& a : r.log.group().arrays) EXPECT_EQ(a.values.size(), 30u) << a.name;
}

/// A strict display shows a frame that took 20 ms after two periods, and one that took 40 ms after three: 36 and 24
/// frames per second.
TEST_F(Sessions, LateFramesAreDividedRates) {
  const LoopResult r = run(options("paper/capsule-sweep", 40), "blind=1,stalls=15:0.02;16:0.02;17:0.02;25:0.04");
  int twice = 0, thrice = 0;
  for (const double p : r.log.periods()) {
    twice += p == 2 ? 1 : 0;
    thrice += p == 3 ? 1 : 0;
  }
  EXPECT_EQ(twice, 3);
  EXPECT_EQ(thrice, 1);
  EXPECT_NEAR(r.summary.at("xr_late_frames"), 4 / 39.0, 1e-12);
  EXPECT_NEAR(r.summary.at("xr_fps_median"), 72, 1e-4);
  EXPECT_NEAR(r.summary.at("xr_fps_worst"), 24, 1e-4);
}

/// For a slow application, runtimes report multiples of the display's period.
TEST_F(Sessions, SlowFramesBeforeTheFirstDoNotChangeTheRate) {
  const LoopOptions o = options("paper/capsule-sweep", 12);
  const LoopResult r = run(o, "blind=1,multiple=200");
  EXPECT_EQ(load_scene(r.scenario.string()).time.frame_rate_hz, 72);
  EXPECT_EQ(replayed(r, o), r.final_position_m);
}

TEST_F(Sessions, WithoutAnyExtensionButVulkanTheScriptIsShown) {
  const LoopOptions o = options("paper/capsule-sweep", 12);
  const LoopResult r = run(o, "hands=0,capsules=0,rate=0,look=10");
  EXPECT_EQ(r.log.rows().size(), 12u);
  EXPECT_EQ(reported_["rate_hz"], 90.0);
  EXPECT_GT(reported_["drawn"][0].get<double>(), 0.05);
  EXPECT_EQ(reported_["counter_calls"], 0);
  EXPECT_TRUE(r.counters.arrays.empty());
  const Scene saved = load_scene(r.scenario.string());
  EXPECT_EQ(saved.time.frame_rate_hz, 90) << "by the frames' predicted period";
  EXPECT_EQ(replayed(r, o), r.final_position_m);
}

TEST_F(Sessions, TheUserMayEndIt) {
  const LoopOptions o = options("paper/capsule-sweep", 500);
  const LoopResult r = run(o, "blind=1,quit=40");
  EXPECT_LT(r.log.rows().size(), 41u);
  EXPECT_GT(r.log.rows().size(), 10u);
  EXPECT_EQ(replayed(r, o), r.final_position_m);
}

/// A garment touched by the user's hand: it is visible although the scene holds it 1.2 m above its origin, and its mesh
/// is saved with the recording.
TEST_F(Sessions, ClothMayBeAMesh) {
  LoopOptions o = options("garments/sleeve", 12);
  o.overrides = {R"(cloth.mesh.file="assets/sleeve-small.obj")"};
  o.device.validation = true;
  const LoopResult r = run(o, "look=10");
  EXPECT_GT(reported_["drawn"][0].get<double>(), 0.02);
  EXPECT_TRUE(std::filesystem::exists(r.scenario.parent_path() / "sleeve-small.obj"));
  EXPECT_TRUE(load_scene(r.scenario.string()).cloth.mesh);
  EXPECT_EQ(replayed(r, o), r.final_position_m);
}

TEST_F(Sessions, ARoomStaysThatOfTheScenario) {
  const LoopOptions o = options("paper/desk-flat-low", 8);
  const LoopResult r = run(o, "blind=1");
  EXPECT_EQ(load_scene(r.scenario.string()).assets, "procedural");
  EXPECT_EQ(replayed(r, o), r.final_position_m);
}

class Counting : public Sessions, public testing::WithParamInterface<const char*> {};
INSTANTIATE_TEST_SUITE_P(Runtimes, Counting, testing::Values("ANDROID=1", "META=1", "ANDROID=1,META=1"));

/// The null runtime's counters count frames; in four frames reading them fails.
TEST_P(Counting, CountersOfTheRuntimeAreStored) {
  const LoopResult r =
      run(options("paper/gravity", 20), std::string("blind=1,planes=1,unmeasured=12:16,") + GetParam());
  EXPECT_EQ(reported_["plane_calls"], 0) << "without --table";
  EXPECT_EQ(reported_["counter_calls"], 2 + 20 * null_xr::kCounters.size()) << "one reading per frame";
  ASSERT_EQ(r.counters.arrays.size(), null_xr::kCounters.size());
  const double first = r.counters.arrays[1].values.at(0);
  ASSERT_LT(first, 12);
  for (std::size_t c = 0; c < null_xr::kCounters.size(); ++c) {
    const auto& [path, units, unit, flags] = null_xr::kCounters[c];
    const StoredArray& a = r.counters.arrays[c];
    EXPECT_EQ(a.name, std::string(path).replace(std::string(path).find('/'), 1, "_"));
    EXPECT_EQ(a.units, units) << a.name;
    ASSERT_EQ(a.values.size(), 20u) << a.name;
    for (double frame = first; frame < first + 20; ++frame) {
      const double value = a.values[static_cast<std::size_t>(frame - first)];
      EXPECT_TRUE(frame >= 12 && frame < 16 ? std::isnan(value) : value == ((flags & 4) != 0 ? frame / 2 : frame));
    }
  }
}

/// With labels and without, by its height. A cloth falls onto it as onto the scene's own table, which is gone.
class OnATable : public Sessions, public testing::WithParamInterface<const char*> {};
INSTANTIATE_TEST_SUITE_P(Labels, OnATable, testing::Values("planes=1", "planes=1,labels=0"));

TEST_P(OnATable, TheUsersReplacesTheScenes) {
  LoopOptions o = options("paper/desk-corner-low", 30);
  o.table = true;
  o.overrides = {"cloth.grid=[12,12]", "cloth.pose.over_table.drop_m=0.2", "colliders.0.friction=0.7",
                 "colliders.1={\"type\":\"hand_capsules\",\"track\":\"assets/right-hand-sweep.json\"}"};
  const LoopResult r = run(o, std::string("blind=1,") + GetParam());
  const Scene scene = load_scene(r.scenario.string());
  ASSERT_EQ(scene.colliders.size(), 2u);
  EXPECT_EQ(scene.motion.back().colliders.at(0).capsules.size(), 19u);
  const Collider& box = scene.colliders[1];
  const auto space = reported_["space"].get<Vec3>();
  const auto& [pose, width_m, height_m, alignment, label, state] = null_xr::kSurroundings.back();
  const null_xr::V up = turned(pose.q, {0, 0, 1}), along = turned(pose.q, {1, 0, 0}), top = pose.p + -0.02 * up;
  const Vec3 half = {width_m / 2, height_m / 2, 0.02}, center = {top.x, top.y, top.z}, x = {along.x, along.y, along.z};
  for (std::size_t k = 0; k < 3; ++k) {
    EXPECT_NEAR(box.half_extent_m[k], half[k], kFloat_m);
    EXPECT_NEAR(box.axes[0][k], x[k], kFloat_m);
    EXPECT_NEAR(box.center_m[k] + space[k], center[k], kFloat_m);
  }
  EXPECT_EQ(box.friction, 0.7);
  const auto above = [&](const std::vector<double>& p) {
    return render::Bounds::of(p).low[1] - box.center_m[1] - 0.02;
  };
  EXPECT_NEAR(above(initial_positions(scene)), 0.2, kFloat_m);
  EXPECT_NEAR(above(r.final_position_m), 0.004, 0.002) << "it lies on the table";
  const assets::HandRecording hand = recording_of(r.scenario.parent_path() / "right-hand.json");
  EXPECT_NEAR(static_cast<double>(hand.frames[0].joints[0].position_m[1]) + space[1], -0.15, kFloat_m);
  EXPECT_EQ(replayed(r, o), r.final_position_m);
}

TEST_F(Sessions, ACpuSolverIsUploaded) {
  const LoopOptions o = options("paper/gravity", 10, "ballistic");
  const LoopResult r = run(o, "look=10");
  EXPECT_GT(reported_["drawn"][1].get<double>(), 0.02);
  EXPECT_EQ(replayed(r, o), r.final_position_m);
}

void expect_error(const LoopOptions& o, ExitCode code, const std::string& words) {
  EXPECT_PRED2(mentions, refusal([&] { run_loop(o); }, code), words);
}

TEST_F(Sessions, WhatIsMissingIsSaid) {
  LoopOptions o = options("paper/capsule-sweep", 10);
  setenv("XR_RUNTIME_JSON", "/no/such/runtime.json", 1);
  expect_error(o, ExitCode::NoDevice, "no OpenXR runtime");
  setenv("XR_RUNTIME_JSON", CLOTHBENCH_NULL_RUNTIME, 1);
  setenv("CLOTHBENCH_NULL_XR", "unseen=0:100000000", 1);
  o.timeout_s = 0.5;
  expect_error(o, ExitCode::CheckFailed, "no hand was seen");
  setenv("CLOTHBENCH_NULL_XR", "", 1);
  o.frames = 9000;
  o.timeout_s = 60;
  expect_error(o, ExitCode::BadInput, "1 to 8640");
  o = options("paper/capsule-sweep", 10);
  o.table = true;
  expect_error(o, ExitCode::NoDevice, "XR_EXT_spatial_plane_tracking, which --table needs");
  setenv("CLOTHBENCH_NULL_XR", "planes=2,blind=1", 1);
  o.timeout_s = 4;
  expect_error(o, ExitCode::CheckFailed, "no table was found");
  o = options("garments/sleeve", 10);
  o.overrides = {R"(cloth.mesh.file="none.obj")"};
  expect_error(o, ExitCode::BadInput, "/cloth/mesh/file");
  o = options("paper/capsule-sweep", 10);
  setenv("CLOTHBENCH_NULL_XR", "vulkan=0", 1);  // last: the loader keeps the list of extensions
  expect_error(o, ExitCode::NoDevice, "XR_KHR_vulkan_enable2");
}

/// A point seen by an eye is where the tangents of the field of view put it.
TEST(Views, AnEyesClipSpace) {
  using render::operator*;
  const XrFovf fov{-0.9f, 0.6f, 0.8f, -0.7f};
  const float h = std::sqrt(0.5f);
  const XrPosef pose{{0, h, 0, h}, {1, 2, 3}};  // turned left: it looks along -x
  const Vec3 origin = {0.5, 0, 0};
  const render::Mat4 m = projection_of(fov, 0.1, 50) * view_of(pose, origin);
  const auto clip = [&](Vec3 p) {
    std::array<double, 4> c{};
    for (std::size_t row = 0; row < 4; ++row)
      c[row] =
          m[row] * (p[0] - origin[0]) + m[4 + row] * (p[1] - origin[1]) + m[8 + row] * (p[2] - origin[2]) + m[12 + row];
    return std::array<double, 3>{c[0] / c[3], c[1] / c[3], c[2] / c[3]};
  };
  const double d = 2;
  const auto at = [&](double right, double up) { return Vec3{1 - d, 2 + d * up, 3 - d * right}; };  // its right is -z
  const auto low_left = clip(at(std::tan(-0.9), std::tan(-0.7))), high_right = clip(at(std::tan(0.6), std::tan(0.8)));
  EXPECT_NEAR(low_left[0], -1, 1e-6);
  EXPECT_NEAR(low_left[1], 1, 1e-6) << "y is down";
  EXPECT_NEAR(high_right[0], 1, 1e-6);
  EXPECT_NEAR(high_right[1], -1, 1e-6);
  EXPECT_NEAR(clip({1 - 0.1, 2, 3})[2], 0, 1e-5);
  EXPECT_NEAR(clip({1 - 50, 2, 3})[2], 1, 1e-5);
}

}  // namespace
}  // namespace clothbench::xr

#include <gtest/gtest.h>

#include <cmath>
#include <filesystem>
#include <nlohmann/json.hpp>

#include "assets/hand_track.hpp"
#include "base/json_text.hpp"
#include "clothbench/error.hpp"
#include "refusal.hpp"
#include "support.hpp"

namespace clothbench::assets {
namespace {

RecordedHand hand_at(float x) {
  RecordedHand h;
  for (std::size_t k = 0; k < h.joints.size(); ++k) {
    h.joints[k].position_m = {x, 0.01f * static_cast<float>(k), 1.0f / 3};
    h.joints[k].radius_m = 0.01f;
  }
  for (std::size_t k = 0; k < h.capsules.size(); ++k)
    h.capsules[k] = {{x, 0, 0}, {x, 0.1f * static_cast<float>(k), 0}, 0.02f};
  return h;
}

HandRecording recording() { return {Side::Left, 72, true, {hand_at(0), hand_at(0.1f), hand_at(0.3f)}}; }

TEST(Recording, IsReadAsItWasWritten) {
  const HandRecording r = recording();
  const std::string text = to_json(r, "a test");
  const HandRecording again = parse_hand_recording(text, "test");
  EXPECT_EQ(again.side, Side::Left);
  ASSERT_EQ(again.frames.size(), 3u);
  for (std::size_t f = 0; f < 3; ++f)
    for (std::size_t k = 0; k < kRecordedJointCount; ++k) {
      EXPECT_EQ(again.frames[f].joints[k].position_m, r.frames[f].joints[k].position_m);
      EXPECT_EQ(again.frames[f].joints[k].orientation, r.frames[f].joints[k].orientation);
    }
  EXPECT_EQ(again.frames[2].capsules[18].b_m, r.frames[2].capsules[18].b_m);
  EXPECT_EQ(to_json(again, "a test"), text);
  EXPECT_TRUE(is_hand_recording(nlohmann::json::parse(text)));
  EXPECT_FALSE(is_hand_recording(nlohmann::json::parse(R"({"hand": "left", "keys": []})")));
}

TEST(Recording, FramesAreExactAndThereIsNoneBetweenThem) {
  const HandRecording r = recording();
  for (int k = 0; k < 3; ++k)
    EXPECT_EQ(r.at(k * (1 / 72.0)).joints[5].position_m, r.frames[static_cast<std::size_t>(k)].joints[5].position_m);
  EXPECT_THROW(r.at(1.5 / 72), Error);
  EXPECT_EQ(r.at(-1).joints[5].position_m, r.frames[0].joints[5].position_m);
  EXPECT_EQ(r.at(99).joints[5].position_m, r.frames[2].joints[5].position_m);
  EXPECT_THROW(r.at(NAN), Error);
}

TEST(Recording, WithoutCapsulesThoseOfTheJoints) {
  HandRecording r = recording();
  EXPECT_EQ(capsules(r, r.frames[0])[2].radius_m, static_cast<double>(0.02f));
  r.has_capsules = false;
  const auto c = capsules(r, r.frames[0]);
  EXPECT_EQ(c[2].radius_m, static_cast<double>(0.01f));
  EXPECT_NEAR(c[0].a.y(), 0.01 * 6, 1e-6) << "metacarpal of the index finger: joint 6 of OpenXR";
}

std::string refused(const nlohmann::json& j) {
  return refusal([&] { parse_hand_recording(j.dump(), "file.json"); });
}

TEST(Recording, DamageIsNamed) {
  const nlohmann::json good = nlohmann::json::parse(to_json(recording(), "a test"));
  EXPECT_EQ(refused(good), "");
  const auto with = [&](const char* pointer, const nlohmann::json& value) {
    nlohmann::json j = good;
    j[nlohmann::json::json_pointer(pointer)] = value;
    return refused(j);
  };
  EXPECT_PRED2(mentions, with("/recording/frames", 4), "file.json: /recording/joints: 78 joints; expected 26");
  EXPECT_NE(with("/recording/frames", 0), "");
  EXPECT_PRED2(mentions, with("/recording/frame_rate_hz", 0), "/recording/frame_rate_hz");
  EXPECT_PRED2(mentions, with("/recording/joints", "AAA"), "/recording/joints");
  EXPECT_PRED2(mentions, with("/recording/joints", std::string(78 * 32 / 3 * 4, 'A')), "unit quaternion") << "zeros";
  EXPECT_PRED2(mentions, with("/recording/capsules", ""), "0 capsules");
  EXPECT_PRED2(mentions, with("/recording/speed", 1), "speed") << "unknown keys";
  EXPECT_PRED2(mentions, with("/hand", "rihgt"), "right");
}

namespace fs = std::filesystem;
const fs::path kTracks = fs::path(CLOTHBENCH_SOURCE_DIR) / "scenarios/assets";

const char* const kTwoKeys = R"({"hand": "right", "keys": [
  {"time_s": 1, "pose": "relaxed", "position_m": [0, 0, 0], "grip": true},
  {"time_s": 3, "pose": "relaxed", "blend": {"to": "pinch", "amount": 0.5}, "position_m": [2, 4, -6], "rotation_deg": [0, 90, 0]}]})";

TEST(HandTrack, InterpolatesPositionOrientationAndPose) {
  const Hand hand = open_hand(AssetSource{}, Side::Right);
  const HandTrack track = parse_hand_track(kTwoKeys, "t");
  const HandSample half = sample(track, hand, 2);
  const Frame palm = palm_frame(half.pose);
  EXPECT_LT((palm.translation() - Vector(1, 2, -3)).norm(), 1e-9);
  const Eigen::Quaterniond expected(Eigen::AngleAxisd(EIGEN_PI / 4, Vector::UnitY()));
  EXPECT_LT(Eigen::Quaterniond(palm.linear()).angularDistance(expected), 1e-6);
  // Half-way to a half pinch, the hand pinches by a quarter, within the error of nested slerps.
  const HandPose quarter = blended(hand.pose("relaxed"), hand.pose("pinch"), 0.25);
  const HandPose local = in_palm_frame(half.pose);
  for (std::size_t j = 0; j < kJointCount; ++j) {
    EXPECT_LT((local.joints[j].translation() - quarter.joints[j].translation()).norm(), 1e-9);
    EXPECT_NEAR(local.radius_m[j], quarter.radius_m[j], 1e-12);
  }
}

TEST(HandTrack, StandsStillOutsideItsKeys) {
  const Hand hand = open_hand(AssetSource{}, Side::Right);
  const HandTrack track = parse_hand_track(kTwoKeys, "t");
  EXPECT_LT(palm_frame(sample(track, hand, 0).pose).translation().norm(), 1e-12);
  EXPECT_LT((palm_frame(sample(track, hand, 99).pose).translation() - Vector(2, 4, -6)).norm(), 1e-12);
  EXPECT_FALSE(sample(track, hand, 0.5).grip);
  EXPECT_TRUE(sample(track, hand, 1).grip);
  EXPECT_TRUE(sample(track, hand, 2.999).grip);
  EXPECT_FALSE(sample(track, hand, 3).grip);
  EXPECT_NE(error_of([&] { sample(track, hand, std::numeric_limits<double>::quiet_NaN()); }), "");
  EXPECT_PRED2(mentions, error_of([&] { sample(track, open_hand(AssetSource{}, Side::Left), 0); }), "right");
}

TEST(HandTrack, RotationTurnsAboutXThenYThenZ) {
  const HandTrack track = parse_hand_track(
      R"({"hand": "right", "keys": [{"time_s": 0, "pose": "point", "position_m": [0,0,0], "rotation_deg": [90, 0, 90]}]})",
      "t");
  // The first rotation maps y to z; the second one leaves z unchanged.
  EXPECT_LT((track.keys[0].orientation * Vector::UnitY() - Vector::UnitZ()).norm(), 1e-12);
  EXPECT_LT((track.keys[0].orientation * Vector::UnitX() - Vector::UnitY()).norm(), 1e-12);
}

TEST(HandTrack, PinchAnchorPlacesThePinchPoint) {
  const Hand hand = open_hand(AssetSource{}, Side::Right);
  const HandTrack track = parse_hand_track(
      R"({"hand": "right", "anchor": "pinch", "keys": [
        {"time_s": 0, "pose": "pinch", "position_m": [1, 2, 3], "rotation_deg": [0, 74, 0]},
        {"time_s": 1, "pose": "relaxed", "position_m": [1, 2, 3]}]})",
      "t");
  for (double t : {0.0, 0.3, 1.0})
    EXPECT_LT((pinch_point(sample(track, hand, t).pose) - Vector(1, 2, 3)).norm(), 1e-12) << t;
  EXPECT_LT(track.keys[1].orientation.angularDistance(track.keys[0].orientation), 1e-12)
      << "stays as in the key before";
}

TEST(HandTrack, DamageIsNamedWithItsPlace) {
  const struct {
    const char *from, *to, *pointer, *says;
  } bad[] = {
      {"\"grip\"", "\"gripp\"", "/keys/0", "nearest known: grip"},
      {"\"position_m\"", "\"position_cm\"", "/keys/0", "position_m"},
      {"\"pose\": \"relaxed\", ", "", "/keys/0", "first key"},
      {"\"relaxed\"", "\"relaxt\"", "/keys/0/pose", "one of [\"relaxed\""},
      {"\"right\"", "\"both\"", "/hand", "one of [\"left\",\"right\"]"},
      {"\"time_s\": 3", "\"time_s\": 1", "/keys/1/time_s", "later"},
      {"\"time_s\": 1", "\"time_s\": -1", "/keys/0/time_s", ">= 0"},
      {"[2, 4, -6]", "[2, 4]", "/keys/1/position_m", "3 items"},
      {"[2, 4, -6]", "[2, \"4\", -6]", "/keys/1/position_m/1", "expected number"},
      {"[2, 4, -6]", "[2, NaN, -6]", "line 3", "not valid JSON"},
      {"[2, 4, -6]", "[2, 1e999, -6]", "line 3", "double range"},
      {"[2, 4, -6]", "[2, 4e9, -6]", "/keys/1/position_m/1", "<= 10000"},
      {"0.5", "1.5", "/keys/1/blend/amount", "<= 1"},
      {"\"amount\"", "\"by\"", "/keys/1/blend", "unknown key"},
      {"\"grip\": true", "\"grip\": 1", "/keys/0/grip", "expected boolean"},
      {"\"grip\": true", "\"grip\": true, \"grip\": false", "grip", "twice"},
      {R"({"hand": "right",)", R"({"hand": "right", "why": [],)", "/why", "expected string"},
  };
  for (const auto& b : bad) {
    const std::string text = replaced(kTwoKeys, b.from, b.to);
    const std::string message = error_of([&] { parse_hand_track(text, "my-track.json"); });
    EXPECT_EQ(message.find("my-track.json: "), 0u) << message;
    EXPECT_PRED2(mentions, message, b.pointer);
    EXPECT_PRED2(mentions, message, b.says);
  }
  EXPECT_PRED2(mentions, error_of([] { parse_hand_track(R"({"hand": "left", "keys": []})", "t"); }),
               "/keys: expected array, at least 1 items");
}

TEST(HandTrack, AllOfTheScenariosLoad) {
  std::size_t count = 0;
  for (const auto& entry : fs::directory_iterator(kTracks)) {
    if (entry.path().extension() != ".json") continue;
    const HandTrack track = parse_hand_track(read_text(entry.path()), entry.path().string());
    EXPECT_EQ(entry.path().filename().string().starts_with(std::string(name_of(track.side))), true) << entry.path();
    const Hand hand = open_hand(locate_assets(false), track.side);
    for (double t = 0; t <= track.duration_s(); t += 1.0 / 72)
      for (const Frame& joint : sample(track, hand, t).pose.joints) ASSERT_TRUE(joint.matrix().allFinite());
    ++count;
  }
  EXPECT_GE(count, 8u);
}

TEST(HandTrack, ASweepIsGoneAtAnotherSpeedAndTheRestComesLater) {
  const HandTrack track = parse_hand_track(R"({"hand": "right", "keys": [
    {"time_s": 0, "pose": "relaxed", "position_m": [0, 0, 0]},
    {"time_s": 1, "position_m": [0, 0, 0], "sweep": true},
    {"time_s": 2, "position_m": [3, 0, 4]},
    {"time_s": 2.5, "position_m": [3, 0, 4]},
    {"time_s": 3, "position_m": [0, 0, 0]}]})",
                                           "t");
  const HandTrack slow = retimed(track, 2);
  EXPECT_EQ(slow.keys[1].time_s, 1);
  EXPECT_NEAR(slow.keys[2].time_s, 3.5, 1e-12) << "5 m at 2 m/s";
  EXPECT_NEAR(slow.keys[3].time_s, 4, 1e-12);
  EXPECT_NEAR(slow.duration_s(), 4.5, 1e-12);
  EXPECT_NEAR(retimed(track, 20).duration_s(), 2.25, 1e-12);
  EXPECT_THROW(retimed(track, 0), Error);
  EXPECT_THROW(retimed(track, 1e-9), Error) << "longer than a day";
  EXPECT_THROW(retimed(parse_hand_track(kTwoKeys, "t"), 1), Error) << "no sweep";
}

}  // namespace
}  // namespace clothbench::assets

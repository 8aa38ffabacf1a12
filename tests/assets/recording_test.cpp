#include <gtest/gtest.h>

#include <cmath>
#include <nlohmann/json.hpp>

#include "assets/hand_recording.hpp"
#include "refusal.hpp"

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

}  // namespace
}  // namespace clothbench::assets

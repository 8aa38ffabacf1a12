#include <gtest/gtest.h>

#include <cmath>
#include <nlohmann/json.hpp>

#include "assets/hand_recording.hpp"
#include "assets/json_at.hpp"
#include "assets/room.hpp"
#include "assets/submesh.hpp"
#include "clothbench/error.hpp"

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

RecordedMesh tetrahedron() {
  RecordedMesh m;
  // Its first vertex twice, as where a texture is cut.
  m.positions_m = {0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0};
  m.triangles = {{0, 2, 1}, {0, 1, 3}, {4, 3, 2}, {1, 2, 3}};
  m.joints.assign(5, {1, 2, 0, 0});
  m.weights.assign(5, {0.25f, 0.75f, 0, 0});
  return m;
}

HandRecording recording() {
  return {Side::Left, 72, true, {hand_at(0), hand_at(0.1f), hand_at(0.3f)}, welded(tetrahedron(), "test")};
}

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
  ASSERT_TRUE(again.mesh);
  EXPECT_EQ(again.mesh->positions_m, r.mesh->positions_m);
  EXPECT_EQ(again.mesh->triangles, r.mesh->triangles);
  EXPECT_EQ(to_json(again, "a test"), text);
  EXPECT_TRUE(is_hand_recording(nlohmann::json::parse(text)));
  EXPECT_FALSE(is_hand_recording(nlohmann::json::parse(R"({"hand": "left", "keys": []})")));
}

TEST(Recording, FramesAreExactAndBetweenThemItIsBlended) {
  const HandRecording r = recording();
  for (int k = 0; k < 3; ++k)
    EXPECT_EQ(r.at(k * (1 / 72.0)).joints[5].position_m, r.frames[static_cast<std::size_t>(k)].joints[5].position_m);
  EXPECT_NEAR(static_cast<double>(r.at(1.5 / 72).joints[5].position_m[0]), 0.2, 1e-6);
  EXPECT_NEAR(static_cast<double>(r.at(0.25 / 72).capsules[3].a_m[0]), 0.025, 1e-6);
  EXPECT_EQ(r.at(-1).joints[5].position_m, r.frames[0].joints[5].position_m);
  EXPECT_EQ(r.at(99).joints[5].position_m, r.frames[2].joints[5].position_m);
  EXPECT_THROW(r.at(NAN), Error);
}

TEST(Recording, CutsAreWelded) {
  const RecordedMesh m = welded(tetrahedron(), "test");
  EXPECT_EQ(m.positions_m.size(), 12u);
  TriangleMesh t;
  t.positions.assign(m.positions_m.begin(), m.positions_m.end());
  t.triangles = m.triangles;
  EXPECT_TRUE(topology(t).closed_manifold());
  EXPECT_GT(signed_volume(t), 0);
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
  try {
    parse_hand_recording(j.dump(), "file.json");
  } catch (const Error& e) {
    return e.what();
  }
  return "";
}

TEST(Recording, DamageIsNamed) {
  const nlohmann::json good = nlohmann::json::parse(to_json(recording(), "a test"));
  EXPECT_EQ(refused(good), "");
  const auto with = [&](const char* pointer, const nlohmann::json& value) {
    nlohmann::json j = good;
    j[nlohmann::json::json_pointer(pointer)] = value;
    return refused(j);
  };
  EXPECT_NE(with("/recording/frames", 4).find("file.json: /recording/joints: 78 joints; expected 26"),
            std::string::npos);
  EXPECT_NE(with("/recording/frames", 0), "");
  EXPECT_NE(with("/recording/frame_rate_hz", 0).find("/recording/frame_rate_hz"), std::string::npos);
  EXPECT_NE(with("/recording/joints", "AAA").find("/recording/joints"), std::string::npos);
  EXPECT_NE(with("/recording/joints", std::string(78 * 32 / 3 * 4, 'A')).find("unit quaternion"), std::string::npos)
      << "zeros";
  EXPECT_NE(with("/recording/capsules", "").find("0 capsules"), std::string::npos);
  EXPECT_NE(with("/recording/speed", 1).find("speed"), std::string::npos) << "unknown keys";
  EXPECT_NE(with("/hand", "rihgt").find("right"), std::string::npos);
  RecordedMesh m = tetrahedron();
  m.triangles[0][1] = 9;
  EXPECT_THROW(welded(m, "test"), Error);
  m = tetrahedron();
  m.weights[2] = {0.5f, 0.1f, 0, 0};
  EXPECT_THROW(welded(m, "test"), Error);
  m = tetrahedron();
  m.joints[2][0] = 26;
  EXPECT_THROW(welded(m, "test"), Error);
  m = tetrahedron();
  m.positions_m[4] = NAN;
  EXPECT_THROW(welded(m, "test"), Error);
}

TEST(Base64, BothWays) {
  for (std::size_t n = 0; n < 40; ++n) {
    std::vector<std::uint8_t> bytes, again;
    for (std::size_t k = 0; k < n; ++k) bytes.push_back(static_cast<std::uint8_t>(37 * k + 11 * n));
    std::string problem;
    ASSERT_TRUE(decode_base64(encode_base64(bytes.data(), n), again, problem)) << n << " " << problem;
    EXPECT_EQ(again, bytes);
  }
  const std::uint8_t foob[] = {'f', 'o', 'o', 'b'};
  EXPECT_EQ(encode_base64(foob, 4), "Zm9vYg==") << "RFC 4648 section 10";
}

TEST(PickedTable, FillsItsBox) {
  const Box box(Vector(-1, 0.2, -3), Vector(2, 0.7, -1));
  const Table t = table_in(box);
  EXPECT_NEAR(t.top_height(), 0.7, 1e-12);
  Box seen;
  for (const Vector& c : t.top_corners()) seen.extend(c);
  EXPECT_NEAR((seen.min() - Vector(-1, 0.7, -3)).norm(), 0, 1e-12);
  EXPECT_NEAR((seen.max() - Vector(2, 0.7, -1)).norm(), 0, 1e-12);
}

}  // namespace
}  // namespace clothbench::assets

#include "assets/hand_recording.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>

#include "assets/json_at.hpp"
#include "base/json_text.hpp"
#include "clothbench/error.hpp"

namespace clothbench::assets {
namespace {

static_assert(sizeof(RecordedJoint) == 32 && sizeof(RecordedCapsule) == 28, "stored as they lie in memory");

constexpr double kMostRate_hz = 1000;
constexpr float kMostCoordinate_m = 1e4f;
constexpr double kUnit = 1e-3;  // how far from 1 a norm of float32 or a sum of weights may be

template <class Item>
std::string block(const Item* items, std::size_t count) {
  return encode_base64(reinterpret_cast<const std::uint8_t*>(items), count * sizeof(Item));
}

bool good(const RecordedJoint& j) {
  double norm = 0;
  for (const float q : j.orientation) norm += static_cast<double>(q) * static_cast<double>(q);
  for (const float x : j.position_m)
    if (!(std::abs(x) <= kMostCoordinate_m)) return false;
  return std::abs(std::sqrt(norm) - 1) <= kUnit && j.radius_m >= 0 && j.radius_m <= kMostCoordinate_m;
}

bool good(const RecordedCapsule& c) {
  for (const auto& end : {c.a_m, c.b_m})
    for (const float x : end)
      if (!(std::abs(x) <= kMostCoordinate_m)) return false;
  return c.radius_m >= 0 && c.radius_m <= kMostCoordinate_m;
}

template <class Items>
void check_all(const Items& items, const JsonAt& at, const char* expected) {
  for (std::size_t k = 0; k < items.size(); ++k)
    if (!good(items[k])) at.fail(fmt::format("number {}: expected {}", k, expected));
}

Eigen::Quaterniond quaternion(const RecordedJoint& j) {
  const auto& q = j.orientation;
  return Eigen::Quaterniond(static_cast<double>(q[3]), static_cast<double>(q[0]), static_cast<double>(q[1]),
                            static_cast<double>(q[2]))
      .normalized();
}

Vector vector(const std::array<float, 3>& p) {
  return {static_cast<double>(p[0]), static_cast<double>(p[1]), static_cast<double>(p[2])};
}

}  // namespace

bool usable(const RecordedHand& hand) {
  return std::all_of(hand.joints.begin(), hand.joints.end(), [](const RecordedJoint& j) { return good(j); }) &&
         std::all_of(hand.capsules.begin(), hand.capsules.end(), [](const RecordedCapsule& c) { return good(c); });
}

const RecordedHand& HandRecording::at(double time_s) const {
  constexpr double kSame = 1e-6;  // of a frame: times are whole frames up to rounding
  const double frame = std::clamp(time_s * frame_rate_hz, 0.0, static_cast<double>(frames.size() - 1));
  if (!(std::abs(frame - std::round(frame)) <= kSame))
    throw Error(fmt::format("hand recording: no frame at {:g} s; expected the scene to run at the recording's {:g} Hz",
                            time_s, frame_rate_hz));
  return frames[static_cast<std::size_t>(std::lround(frame))];
}

bool is_hand_recording(const nlohmann::json& track) { return track.is_object() && track.contains("recording"); }

HandRecording parse_hand_recording(const std::string& text, const std::string& source) {
  const nlohmann::json document = parse_json(text, source);
  const JsonAt root(document, source);
  root.only({"hand", "why", "recording"});
  HandRecording r;
  r.side = root.key("hand").word({"left", "right"}) == "left" ? Side::Left : Side::Right;
  if (const auto why = root.maybe("why")) why->text();
  const JsonAt at = root.key("recording");
  at.only({"frame_rate_hz", "frames", "joints", "capsules"});
  const JsonAt rate = at.key("frame_rate_hz"), count_at = at.key("frames");
  r.frame_rate_hz = rate.number();
  if (!(r.frame_rate_hz > 0 && r.frame_rate_hz <= kMostRate_hz))
    rate.fail(fmt::format("expected above 0 and at most {} Hz", kMostRate_hz));
  const JsonAt joints_where = at.key("joints");
  const auto joints = joints_where.items<RecordedJoint>();
  check_all(joints, joints_where, "a finite position, a unit quaternion and a radius of at least 0");
  const double count = count_at.number();
  if (!(count >= 1 && count == std::floor(count) && count * kRecordedJointCount == static_cast<double>(joints.size())))
    joints_where.fail(fmt::format("{} joints; expected {} for each of {} frames, at least one", joints.size(),
                                  kRecordedJointCount, count));
  r.frames.resize(static_cast<std::size_t>(count));
  for (std::size_t k = 0; k < joints.size(); ++k)
    r.frames[k / kRecordedJointCount].joints[k % kRecordedJointCount] = joints[k];
  if (const auto capsules_where = at.maybe("capsules")) {
    r.has_capsules = true;
    const auto all = capsules_where->items<RecordedCapsule>();
    check_all(all, *capsules_where, "finite ends and a radius of at least 0");
    if (all.size() != r.frames.size() * kCapsuleCount)
      capsules_where->fail(fmt::format("{} capsules; expected {} per frame", all.size(), kCapsuleCount));
    for (std::size_t k = 0; k < all.size(); ++k) r.frames[k / kCapsuleCount].capsules[k % kCapsuleCount] = all[k];
  }
  return r;
}

HandRecording read_hand_recording(const std::filesystem::path& path) {
  return parse_hand_recording(read_text(path), path.string());
}

std::string to_json(const HandRecording& r, const std::string& why) {
  std::vector<RecordedJoint> joints;
  std::vector<RecordedCapsule> capsules;
  for (const RecordedHand& f : r.frames) {
    joints.insert(joints.end(), f.joints.begin(), f.joints.end());
    capsules.insert(capsules.end(), f.capsules.begin(), f.capsules.end());
  }
  nlohmann::json recording = {
      {"frame_rate_hz", r.frame_rate_hz}, {"frames", r.frames.size()}, {"joints", block(joints.data(), joints.size())}};
  if (r.has_capsules) recording["capsules"] = block(capsules.data(), capsules.size());
  return nlohmann::json({{"hand", name_of(r.side)}, {"why", why}, {"recording", recording}}).dump(1) + "\n";
}

Frame frame_of(const RecordedJoint& j) {
  Frame f = Frame::Identity();
  f.linear() = quaternion(j).toRotationMatrix();
  f.translation() = vector(j.position_m);
  return f;
}

HandPose pose_of(const RecordedHand& hand) {
  HandPose pose;
  for (std::size_t k = 0; k < kJointCount; ++k) {
    pose.joints[k] = frame_of(hand.joints[k + 1]);
    pose.radius_m[k] = static_cast<double>(hand.joints[k + 1].radius_m);
  }
  return pose;
}

std::array<Capsule, kCapsuleCount> capsules(const HandRecording& recording, const RecordedHand& hand) {
  if (!recording.has_capsules) return capsules(pose_of(hand));
  std::array<Capsule, kCapsuleCount> out;
  for (std::size_t k = 0; k < kCapsuleCount; ++k) {
    const RecordedCapsule& c = hand.capsules[k];
    out[k] = {vector(c.a_m), vector(c.b_m), static_cast<double>(c.radius_m), -1};
  }
  return out;
}

}  // namespace clothbench::assets

#include "assets/hand_recording.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>

#include "assets/base64.hpp"
#include "base/json_text.hpp"
#include "clothbench/error.hpp"

namespace clothbench::assets {
namespace {

static_assert(sizeof(RecordedJoint) == 32 && sizeof(RecordedCapsule) == 28, "stored as they lie in memory");

constexpr float kMostCoordinate_m = 1e4f;
constexpr double kUnit = 1e-3;  // how far from 1 a norm of float32 or a sum of weights may be

constexpr char kRecordingSchema[] = R"({
  "type": "object", "required": ["hand", "recording"], "additionalProperties": false, "properties": {
    "hand": {"enum": ["left", "right"]},
    "why": {"type": "string"},
    "recording": {
      "type": "object", "required": ["frame_rate_hz", "frames", "joints"], "additionalProperties": false, "properties": {
        "frame_rate_hz": {"type": "number", "exclusiveMinimum": 0, "maximum": 1000},
        "frames": {"type": "integer", "minimum": 1},
        "joints": {"type": "string"},
        "capsules": {"type": "string"}}}
  }
})";

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

/// `per_frame` items of each frame.
template <class Item>
std::vector<Item> read_block(const nlohmann::json& recording, const char* key, std::size_t per_frame,
                             const char* expected, const std::string& source) {
  const std::string pointer = std::string("/recording/") + key;
  auto items = decode_items<Item>(recording[key].get_ref<const std::string&>(), source, pointer);
  const auto frames = recording["frames"].get<std::size_t>();
  if (items.size() % per_frame != 0 || items.size() / per_frame != frames)
    refuse(source, pointer,
           fmt::format("{} {}; expected {} for each of {} frames", items.size(), key, per_frame, frames));
  for (std::size_t k = 0; k < items.size(); ++k)
    if (!good(items[k])) refuse(source, pointer, fmt::format("number {}: expected {}", k, expected));
  return items;
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
  validate_json(document, kRecordingSchema, source);
  const nlohmann::json& recording = document["recording"];
  HandRecording r;
  r.side = document["hand"] == "left" ? Side::Left : Side::Right;
  r.frame_rate_hz = recording["frame_rate_hz"].get<double>();
  r.has_capsules = recording.contains("capsules");
  const auto joints =
      read_block<RecordedJoint>(recording, "joints", kRecordedJointCount,
                                "a finite position, a unit quaternion and a radius of at least 0", source);
  r.frames.resize(joints.size() / kRecordedJointCount);
  for (std::size_t k = 0; k < joints.size(); ++k)
    r.frames[k / kRecordedJointCount].joints[k % kRecordedJointCount] = joints[k];
  if (!r.has_capsules) return r;
  const auto capsules = read_block<RecordedCapsule>(recording, "capsules", kCapsuleCount,
                                                    "finite ends and a radius of at least 0", source);
  for (std::size_t k = 0; k < capsules.size(); ++k)
    r.frames[k / kCapsuleCount].capsules[k % kCapsuleCount] = capsules[k];
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

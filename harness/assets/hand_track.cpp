#include "assets/hand_track.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>
#include <numbers>

#include "assets/base64.hpp"
#include "base/json_text.hpp"
#include "clothbench/error.hpp"

namespace clothbench::assets {
namespace {

constexpr double kMostSeconds = 86400;

constexpr char kTrackSchema[] =
#include "hand_track.schema.inc"
    ;

Vector vector_of(const nlohmann::json& j) { return {j[0].get<double>(), j[1].get<double>(), j[2].get<double>()}; }

HandPose pose_of(const HandKey& key, const Hand& hand) {
  const HandPose& pose = hand.pose(key.pose);
  return key.blend_to.empty() ? pose : blended(pose, hand.pose(key.blend_to), key.amount);
}

static_assert(sizeof(RecordedJoint) == 32 && sizeof(RecordedCapsule) == 28, "stored as they lie in memory");

constexpr float kMostCoordinate_m = 1e4f;
constexpr double kUnit = 1e-3;  // allowed deviation from 1 of a float32 norm or a sum of weights

constexpr char kRecordingSchema[] =
#include "hand_recording.schema.inc"
    ;

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

/// Decodes `per_frame` items for each frame.
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

Vector vector(const std::array<float, 3>& p) { return Eigen::Vector3f::Map(p.data()).cast<double>(); }

}  // namespace

Eigen::Quaterniond from_degrees(const Vector& degrees) {
  const Vector r = degrees * (std::numbers::pi / 180);
  using Turn = Eigen::AngleAxisd;
  return Eigen::Quaterniond(Turn(r.z(), Vector::UnitZ()) * Turn(r.y(), Vector::UnitY()) * Turn(r.x(), Vector::UnitX()));
}

HandTrack parse_hand_track(const std::string& text, const std::string& source) {
  const nlohmann::json document = parse_json(text, source);
  validate_json(document, kTrackSchema, source);
  HandTrack track;
  track.side = document["hand"] == "left" ? Side::Left : Side::Right;
  track.anchor = document.value("anchor", "palm") == "pinch" ? Anchor::Pinch : Anchor::Palm;
  for (const nlohmann::json& j : document["keys"]) {
    const std::string pointer = fmt::format("/keys/{}", track.keys.size());
    const bool first = track.keys.empty();
    HandKey key = first ? HandKey{} : track.keys.back();
    const double before_s = key.time_s;
    key.time_s = j["time_s"].get<double>();
    if (!first && !(key.time_s > before_s))
      refuse(source, pointer + "/time_s", fmt::format("expected later than the key before, {} s", before_s));
    if (j.contains("pose")) {
      const nlohmann::json blend = j.value("blend", nlohmann::json::object());
      key.pose = j["pose"].get<std::string>();
      key.blend_to = blend.value("to", "");
      key.amount = blend.value("amount", 0.0);
    } else if (first || j.contains("blend")) {
      refuse(source, pointer, "\"pose\" is missing; the first key, and one with \"blend\", must have one");
    }
    key.position_m = vector_of(j["position_m"]);
    if (j.contains("rotation_deg")) key.orientation = from_degrees(vector_of(j["rotation_deg"]));
    key.grip = j.value("grip", false);
    key.sweep = j.value("sweep", false);
    track.keys.push_back(std::move(key));
  }
  return track;
}

HandTrack retimed(HandTrack track, double speed_m_per_s) {
  if (!(speed_m_per_s > 0)) throw Error(fmt::format("hand track: expected a speed above 0, not {} m/s", speed_m_per_s));
  double shift_s = 0;
  bool any = false;
  for (std::size_t i = 0; i + 1 < track.keys.size(); ++i) {
    const HandKey& key = track.keys[i];
    const double before_s = track.keys[i + 1].time_s - (key.time_s - shift_s),
                 distance_m = (track.keys[i + 1].position_m - key.position_m).norm();
    if (key.sweep && !(distance_m > 0))
      throw Error(fmt::format("hand track: key {} is a sweep, but the next key has the same position", i));
    const double takes_s = key.sweep ? distance_m / speed_m_per_s : before_s;
    any = any || key.sweep;
    shift_s += takes_s - before_s;
    track.keys[i + 1].time_s += shift_s;
  }
  if (!any) throw Error("hand track: expected a key with \"sweep\", whose speed can be changed");
  if (!(track.duration_s() <= kMostSeconds))
    throw Error(fmt::format("hand track: at {} m/s it takes {} s: expected at most {}", speed_m_per_s,
                            track.duration_s(), kMostSeconds));
  return track;
}

HandSample sample(const HandTrack& track, const Hand& hand, double time_s) {
  if (track.side != hand.side)
    throw Error(fmt::format("hand track: it is for the {} hand; expected one for the {} hand", name_of(track.side),
                            name_of(hand.side)));
  if (!std::isfinite(time_s)) throw Error("hand track: argument time_s: expected a finite time");
  std::size_t next = 0;
  while (next < track.keys.size() && track.keys[next].time_s <= time_s) ++next;
  const HandKey& a = track.keys[next == 0 ? 0 : next - 1];
  const HandKey& b = track.keys[std::min(next, track.keys.size() - 1)];
  const double t = b.time_s > a.time_s ? (time_s - a.time_s) / (b.time_s - a.time_s) : 0;

  HandSample out;
  out.grip = next > 0 && a.grip;
  const bool same = a.pose == b.pose && a.blend_to == b.blend_to && a.amount == b.amount;
  out.pose = same ? pose_of(a, hand) : blended(pose_of(a, hand), pose_of(b, hand), t);
  Frame place = Frame::Identity();
  place.linear() = a.orientation.slerp(t, b.orientation).normalized().toRotationMatrix();
  place.translation() = (1 - t) * a.position_m + t * b.position_m;
  if (track.anchor == Anchor::Pinch) place.translate(-pinch_point(out.pose));
  out.pose = moved(out.pose, place);
  return out;
}

bool usable(const RecordedHand& hand) {
  return std::all_of(hand.joints.begin(), hand.joints.end(), [](const RecordedJoint& j) { return good(j); }) &&
         std::all_of(hand.capsules.begin(), hand.capsules.end(), [](const RecordedCapsule& c) { return good(c); });
}

const RecordedHand& HandRecording::at(double time_s) const {
  constexpr double kSame = 1e-6;  // a time may differ from a whole frame by this fraction of one
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
  return dump(nlohmann::json({{"hand", name_of(r.side)}, {"why", why}, {"recording", recording}}), 1) + "\n";
}

Frame frame_of(const RecordedJoint& j) {
  Frame f = Frame::Identity();
  const Eigen::Map<const Eigen::Quaternionf> turn(j.orientation.data());
  f.linear() = turn.cast<double>().normalized().toRotationMatrix();
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
    out[k] = {vector(c.a_m), vector(c.b_m), static_cast<double>(c.radius_m)};
  }
  return out;
}

}  // namespace clothbench::assets

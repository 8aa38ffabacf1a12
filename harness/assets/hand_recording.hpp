#pragma once
#include <array>
#include <cstdint>
#include <filesystem>
#include <nlohmann/json_fwd.hpp>
#include <optional>
#include <string>
#include <vector>

#include "assets/hand.hpp"

namespace clothbench::assets {

/// A joint as an OpenXR runtime reports it (XR_EXT_hand_tracking).
struct RecordedJoint {
  std::array<float, 3> position_m{};
  std::array<float, 4> orientation{0, 0, 0, 1};  ///< unit quaternion x, y, z, w
  float radius_m = 0;
};
/// A capsule as an OpenXR runtime reports it (XR_FB_hand_tracking_capsules).
struct RecordedCapsule {
  std::array<float, 3> a_m{}, b_m{};
  float radius_m = 0;
};

/// Joints of OpenXR: the palm, then kJointNames in their order.
inline constexpr std::size_t kRecordedJointCount = kJointCount + 1;

/// A hand at one instant, in the scene's space.
struct RecordedHand {
  std::array<RecordedJoint, kRecordedJointCount> joints;
  std::array<RecordedCapsule, kCapsuleCount> capsules;  ///< all zero if the recording has none
};

/// Whether a recording may contain it: finite positions at most 10 km away, unit quaternions, radii of at least 0 m.
bool usable(const RecordedHand&);

/// Motion of a hand as a headset tracked it, one sample per frame. Numbers are bit-identical to the runtime's.
struct HandRecording {
  Side side = Side::Right;
  double frame_rate_hz = 0;
  bool has_capsules = false;
  std::vector<RecordedHand> frames;  ///< at 0, 1, 2, ... frames

  /// The hand at `time_s`; constant before the first frame and after the last. Throws Error between two frames.
  const RecordedHand& at(double time_s) const;
};

/// Whether the JSON is a recording: an object with "recording" where a hand track has "keys":
/// {"hand": "right", "why": "...",
///  "recording": {"frame_rate_hz": 72, "frames": 2, "joints": "<base64>", "capsules": "<base64>"}}
/// Blocks are little-endian float32: 8 per joint (position, orientation, radius), 7 per capsule (a, b, radius).
/// "capsules" may be left out.
bool is_hand_recording(const nlohmann::json& track);
/// Both throw Error with the file and JSON pointer.
HandRecording read_hand_recording(const std::filesystem::path&);
HandRecording parse_hand_recording(const std::string& text, const std::string& source);
std::string to_json(const HandRecording&, const std::string& why);

/// The pose of the 25 WebXR joints.
HandPose pose_of(const RecordedHand&);
/// The recorded capsules, or `capsules(pose_of(hand))` if the recording has none.
std::array<Capsule, kCapsuleCount> capsules(const HandRecording&, const RecordedHand& hand);
Frame frame_of(const RecordedJoint&);

}  // namespace clothbench::assets

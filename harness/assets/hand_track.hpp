#pragma once
#include <array>
#include <nlohmann/json_fwd.hpp>
#include <string>
#include <vector>

#include "assets/hand.hpp"

namespace clothbench::assets {

/// Rotation about the world's x, then y, then z axis.
Eigen::Quaterniond from_degrees(const Vector& degrees);

/// The point of the hand that `position_m` gives.
enum class Anchor { Palm, Pinch };

/// A pose at one time: `pose`, or its interpolation to `blend_to` by the fraction `amount`.
struct HandKey {
  double time_s = 0;
  std::string pose, blend_to;
  double amount = 0;
  Vector position_m = Vector::Zero();
  Eigen::Quaterniond orientation = Eigen::Quaterniond::Identity();
  bool grip = false;   ///< grips the cloth at the pinch point, from this key to the next
  bool sweep = false;  ///< `retimed` may change the speed from this key to the next
};

/// Motion of a hand through a scene: at least one key, ascending in time.
struct HandTrack {
  Side side = Side::Right;
  Anchor anchor = Anchor::Palm;
  std::vector<HandKey> keys;
  double duration_s() const { return keys.back().time_s; }
};

/// Reads a track, for example
/// {"hand": "right", "anchor": "palm", "why": "...",
///  "keys": [{"time_s": 0, "pose": "relaxed", "blend": {"to": "pinch", "amount": 0.5}, "position_m": [0, 1, 0.1],
///            "rotation_deg": [0, 0, 0], "grip": false, "sweep": false}, ...]}
/// rotation_deg rotates about the world's x, then y, then z axis. Without rotation the fingers point to +y and the palm
/// faces -z. A key without pose or rotation takes it from the previous key; the first key must have a pose. Throws
/// Error with `source` and JSON pointer.
HandTrack parse_hand_track(const std::string& text, const std::string& source);

/// The track with its sweeps at this speed [m/s]; later keys are shifted in time to match. Throws Error if it has no
/// sweep, has a sweep of zero length, or would become too long.
HandTrack retimed(HandTrack, double speed_m_per_s);

struct HandSample {
  HandPose pose;  ///< in world coordinates
  bool grip = false;
};

/// The hand at `time_s`, interpolated between keys: position linearly, orientation by slerp, pose by `blended`.
/// Constant before the first and after the last key. Throws Error if the hand has the wrong side.
HandSample sample(const HandTrack&, const Hand&, double time_s);

/// A joint as OpenXR runtimes report it (XR_EXT_hand_tracking).
struct RecordedJoint {
  std::array<float, 3> position_m{};
  std::array<float, 4> orientation{0, 0, 0, 1};  ///< unit quaternion x, y, z, w
  float radius_m = 0;
};
/// A capsule as OpenXR runtimes report it (XR_FB_hand_tracking_capsules).
struct RecordedCapsule {
  std::array<float, 3> a_m{}, b_m{};
  float radius_m = 0;
};

/// Joints of OpenXR: the palm, then the joints of kJointNames in their order.
inline constexpr std::size_t kRecordedJointCount = kJointCount + 1;

/// A hand at one instant, in the scene's space.
struct RecordedHand {
  std::array<RecordedJoint, kRecordedJointCount> joints;
  std::array<RecordedCapsule, kCapsuleCount> capsules;  ///< all zero if the recording has none
};

/// Whether a recording may contain the hand: finite positions at most 10 km away, unit quaternions, radii >= 0.
bool usable(const RecordedHand&);

/// Motion of a hand as tracked by a headset, one sample per frame. Numbers are bit-identical to the runtime's.
struct HandRecording {
  Side side = Side::Right;
  double frame_rate_hz = 0;
  bool has_capsules = false;
  std::vector<RecordedHand> frames;  ///< at times 0, 1, 2, ... frames

  /// The hand at `time_s`; constant before the first frame and after the last. Throws Error for a time between frames.
  const RecordedHand& at(double time_s) const;
};

/// Whether the JSON is a recording: an object with "recording" instead of the "keys" of a hand track:
/// {"hand": "right", "why": "...",
///  "recording": {"frame_rate_hz": 72, "frames": 2, "joints": "<base64>", "capsules": "<base64>"}}
/// Blocks are little-endian float32: 8 per joint (position, orientation, radius), 7 per capsule (a, b, radius).
/// "capsules" is optional.
bool is_hand_recording(const nlohmann::json& track);
/// Throws Error with `source` and JSON pointer.
HandRecording parse_hand_recording(const std::string& text, const std::string& source);
std::string to_json(const HandRecording&, const std::string& why);

/// The pose of the 25 WebXR joints.
HandPose pose_of(const RecordedHand&);
/// The recorded capsules, or `capsules(pose_of(hand))` if the recording has none.
std::array<Capsule, kCapsuleCount> capsules(const HandRecording&, const RecordedHand& hand);
Frame frame_of(const RecordedJoint&);

}  // namespace clothbench::assets

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

/// A joint as an OpenXR runtime tells it (XR_EXT_hand_tracking).
struct RecordedJoint {
  std::array<float, 3> position_m{};
  std::array<float, 4> orientation{0, 0, 0, 1};  ///< unit quaternion x, y, z, w
  float radius_m = 0;
};
/// A capsule as one tells it (XR_FB_hand_tracking_capsules).
struct RecordedCapsule {
  std::array<float, 3> a_m{}, b_m{};
  float radius_m = 0;
};

/// Of OpenXR: the palm, then kJointNames in their order.
inline constexpr std::size_t kRecordedJointCount = kJointCount + 1;

/// A hand at one instant, in the scene's space.
struct RecordedHand {
  std::array<RecordedJoint, kRecordedJointCount> joints;
  std::array<RecordedCapsule, kCapsuleCount> capsules;  ///< all zero where the recording has none
};

/// Places finite and at most 10 km away, unit quaternions, radii of at least 0: what a recording may hold.
bool usable(const RecordedHand&);

/// The runtime's own mesh of a hand (XR_FB_hand_tracking_mesh), vertices in the same place made one.
struct RecordedMesh {
  std::vector<float> positions_m;                       ///< xyz, at rest
  std::vector<std::array<std::uint32_t, 3>> triangles;  ///< counter-clockwise from outside
  std::vector<std::array<std::uint8_t, 4>> joints;      ///< per vertex, of RecordedHand::joints
  std::vector<std::array<float, 4>> weights;            ///< per vertex, sum 1
  std::array<RecordedJoint, kRecordedJointCount> bind;  ///< joints at rest
};

/// A hand's way as a headset saw it, one instant a frame. Numbers are kept as the runtime gave them, bit for bit.
struct HandRecording {
  Side side = Side::Right;
  double frame_rate_hz = 0;
  bool has_capsules = false;
  std::vector<RecordedHand> frames;  ///< at 0, 1, 2, ... frames
  std::optional<RecordedMesh> mesh;

  /// At `time_s`: the frame itself where one is there, between two of them positions and radii linear, orientations by
  /// slerp; it stands still before the first and after the last.
  RecordedHand at(double time_s) const;
};

/// A recording is a JSON object with "recording" where a hand track has "keys":
/// {"hand": "right", "why": "...", "recording": {"frame_rate_hz": 72, "frames": 2, "joints": "<base64>", "capsules":
/// "<base64>",
///   "mesh": {"positions_m": ..., "triangles": ..., "joints": ..., "weights": ..., "bind": ...}}}
/// Blocks are little-endian: 8 float32 a joint (position, orientation, radius), 7 a capsule (a, b, radius), uint32
/// corners, uint8 joints, float32 weights. "capsules" and "mesh" may be left out.
bool is_hand_recording(const nlohmann::json& track);
/// Throw Error with the file and JSON pointer.
HandRecording read_hand_recording(const std::filesystem::path&);
HandRecording parse_hand_recording(const std::string& text, const std::string& source);
std::string to_json(const HandRecording&, const std::string& why);

/// Throws Error naming `source` unless corners, joints and weights fit the vertices and frames are rigid; weights of a
/// sum off 1 by less than 1e-3 are scaled to it, and vertices in the same place become one.
RecordedMesh welded(RecordedMesh, const std::string& source);

/// The 25 joints of WebXR.
HandPose pose_of(const RecordedHand&);
/// The capsules reported, or those of `capsules(pose_of(hand))` where the recording has none.
std::array<Capsule, kCapsuleCount> capsules(const HandRecording&, const RecordedHand& hand);
Frame frame_of(const RecordedJoint&);

}  // namespace clothbench::assets

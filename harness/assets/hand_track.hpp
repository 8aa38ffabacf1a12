#pragma once
#include <filesystem>
#include <string>
#include <vector>

#include "assets/hand.hpp"

namespace clothbench::assets {

/// Rotation about the world's x, then y, then z axis.
Eigen::Quaterniond from_degrees(const Vector& degrees);

/// Which point of the hand `position_m` places.
enum class Anchor { Palm, Pinch };

/// One pose at one time: `pose`, or its interpolation to `blend_to` by the fraction `amount`.
struct HandKey {
  double time_s = 0;
  std::string pose, blend_to;
  double amount = 0;
  Vector position_m = Vector::Zero();
  Eigen::Quaterniond orientation = Eigen::Quaterniond::Identity();
  bool grip = false;   ///< grips the cloth at the pinch point, from this key to the next
  bool sweep = false;  ///< `retimed` may change the speed from this key to the next
};

/// Motion of a hand through a scene: keys in order of time, at least one.
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
/// faces -z. A key without pose or rotation takes it from the key before;
/// the first key must have a pose. Throws Error with the file and JSON pointer.
HandTrack read_hand_track(const std::filesystem::path&);
HandTrack parse_hand_track(const std::string& text, const std::string& source);

/// The track with its sweeps at this speed [m/s]; later keys are shifted in time accordingly. Throws Error if it has no
/// sweep, has a sweep of zero length, or would take too long.
HandTrack retimed(HandTrack, double speed_m_per_s);

struct HandSample {
  HandPose pose;  ///< in the world
  bool grip = false;
};

/// The hand at `time_s`, interpolated between keys: position linearly, orientation by slerp, pose by `blended`. It is
/// constant before the first and after the last key. Throws Error if the hand is the other one.
HandSample sample(const HandTrack&, const Hand&, double time_s);

}  // namespace clothbench::assets

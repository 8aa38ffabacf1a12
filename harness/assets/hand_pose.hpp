#pragma once
#include <array>
#include <string>
#include <string_view>

#include "assets/mesh.hpp"

namespace clothbench::assets {

enum class Side { Left, Right };
constexpr std::string_view name_of(Side s) { return s == Side::Left ? "left" : "right"; }

/// Joints of the WebXR Hand Input module, in its order. A joint's -z runs along its bone towards the tip, its +y out of
/// the back of the hand.
inline constexpr std::array<std::string_view, 25> kJointNames = {"wrist",
                                                                 "thumb-metacarpal",
                                                                 "thumb-phalanx-proximal",
                                                                 "thumb-phalanx-distal",
                                                                 "thumb-tip",
                                                                 "index-finger-metacarpal",
                                                                 "index-finger-phalanx-proximal",
                                                                 "index-finger-phalanx-intermediate",
                                                                 "index-finger-phalanx-distal",
                                                                 "index-finger-tip",
                                                                 "middle-finger-metacarpal",
                                                                 "middle-finger-phalanx-proximal",
                                                                 "middle-finger-phalanx-intermediate",
                                                                 "middle-finger-phalanx-distal",
                                                                 "middle-finger-tip",
                                                                 "ring-finger-metacarpal",
                                                                 "ring-finger-phalanx-proximal",
                                                                 "ring-finger-phalanx-intermediate",
                                                                 "ring-finger-phalanx-distal",
                                                                 "ring-finger-tip",
                                                                 "pinky-finger-metacarpal",
                                                                 "pinky-finger-phalanx-proximal",
                                                                 "pinky-finger-phalanx-intermediate",
                                                                 "pinky-finger-phalanx-distal",
                                                                 "pinky-finger-tip"};
inline constexpr std::size_t kJointCount = kJointNames.size();
inline constexpr std::size_t kWrist = 0, kThumb = 1, kIndex = 5, kMiddle = 10, kRing = 15,
                             kPinky = 20;  ///< first joints

/// Position in kJointNames, or -1.
int joint_index(std::string_view name);

using JointFrames = std::array<Frame, kJointCount>;

/// A static hand: joint frames, and the radius [m] of the flesh at each joint.
struct HandPose {
  JointFrames joints;
  std::array<double, kJointCount> radius_m{};
};

/// Poses that every hand has.
inline constexpr std::array<std::string_view, 3> kPoseNames = {"relaxed", "pinch", "point"};

/// Reads a pose module of `iwer` (lib/device/configs/hand/*.js): left hand, relative to the pointing ray's space. It
/// parses the object literal and executes no code. Throws Error with file and JSON pointer.
HandPose parse_pose_js(const std::string& text, const std::string& source);

/// The pose of the other hand: reflected in the plane x = 0.
HandPose mirrored(const HandPose&);

/// Frame of the palm: origin half-way along the middle metacarpal (OpenXR's palm joint), +y towards the fingers, +z out
/// of the back of the hand, so the palm faces -z. It rotates with the middle metacarpal.
Frame palm_frame(const HandPose&);
/// The same hand, transformed so that its palm frame is the identity.
HandPose in_palm_frame(const HandPose&);
/// The whole hand transformed by `by`.
HandPose moved(const HandPose&, const Frame& by);
/// Interpolates positions and radii linearly and orientations by slerp; t in [0, 1].
HandPose blended(const HandPose& from, const HandPose& to, double t);

/// Half-way between the tips of thumb and index finger [m].
Vector pinch_point(const HandPose&);

struct Capsule {
  Vector a, b;  ///< ends of the axis [m]
  double radius_m;
  int joint;  ///< index of the joint at `a`
};
inline constexpr std::size_t kCapsuleCount = 19;  ///< as XR_HAND_TRACKING_CAPSULE_COUNT_FB
/// The hand as capsules between WebXR joints, with the radius of the near joint: 4 along the metacarpals of index,
/// middle, ring and little finger (the palm), then 3 for each finger from the thumb on. The last capsule of a finger
/// ends 15 mm beyond its joint, or at the tip joint if that is nearer. Tip joints lie at the skin, so a round end there
/// would protrude from the finger.
std::array<Capsule, kCapsuleCount> capsules(const HandPose&);

}  // namespace clothbench::assets

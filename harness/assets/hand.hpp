#pragma once
#include <array>
#include <cstdint>
#include <functional>
#include <map>
#include <string>
#include <string_view>
#include <vector>

#include "assets/mesh.hpp"

namespace clothbench::assets {

enum class Side { Left, Right };
constexpr std::string_view name_of(Side s) { return s == Side::Left ? "left" : "right"; }

/// Joints of the WebXR Hand Input module, in its order. A joint's -z axis points along its bone to the tip; its +y axis
/// points out of the back of the hand.
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
                             kPinky = 20;  ///< first joint of each finger

/// Position in kJointNames, or -1.
int joint_index(std::string_view name);

using JointFrames = std::array<Frame, kJointCount>;

/// A static hand: joint frames, and the flesh's radius [m] at each joint.
struct HandPose {
  JointFrames joints;
  std::array<double, kJointCount> radius_m{};
};

/// Poses that every hand provides.
inline constexpr std::array<std::string_view, 3> kPoseNames = {"relaxed", "pinch", "point"};

/// Parses a pose module of `iwer` (lib/device/configs/hand/*.js): a left hand, in the space of the pointing ray. Only
/// parses the object literal; executes no code. Throws Error with file and JSON pointer.
HandPose parse_pose_js(const std::string& text, const std::string& source);

/// The pose of the opposite hand: reflection in the plane x = 0.
HandPose mirrored(const HandPose&);

/// Frame of the palm: origin half-way along the middle metacarpal (OpenXR's palm joint), +y towards the fingers, +z out
/// of the back of the hand, so that the palm faces -z. It rotates with the middle metacarpal.
Frame palm_frame(const HandPose&);
/// The hand transformed so that its palm frame is the identity.
HandPose in_palm_frame(const HandPose&);
/// The whole hand, transformed by `by`.
HandPose moved(const HandPose&, const Frame& by);
/// Interpolates positions and radii linearly and orientations by slerp; t in [0, 1].
HandPose blended(const HandPose& from, const HandPose& to, double t);

/// Midpoint of the tips of thumb and index finger [m].
Vector pinch_point(const HandPose&);

struct Capsule {
  Vector a, b;  ///< ends of the axis [m]
  double radius_m;
};
inline constexpr std::size_t kCapsuleCount = 19;  ///< the same number as XR_HAND_TRACKING_CAPSULE_COUNT_FB
/// The hand as capsules between WebXR joints, with the radius of the joint nearer to the wrist: 4 along the metacarpals
/// of index, middle, ring and little finger (the palm), then 3 per finger, thumb first. The last capsule of a finger
/// ends 15 mm beyond its joint, or at the tip joint if that is nearer. Tip joints are on the skin, so a round end there
/// would protrude.
std::array<Capsule, kCapsuleCount> capsules(const HandPose&);

/// A closed mesh that follows joints by linear blend skinning: x = sum_k w_k J_k B_k x_rest, with J the joint's frame
/// and B the inverse of its rest frame.
struct SkinnedMesh {
  TriangleMesh rest;
  std::vector<std::array<std::uint8_t, 4>> joints;  ///< per vertex, indices into kJointNames
  std::vector<std::array<double, 4>> weights;       ///< per vertex, sum 1
  std::array<Eigen::Affine3d, kJointCount> inverse_bind;
};

/// Reads the WebXR generic hand (binary glTF: one mesh, one primitive, one skin with the 25 WebXR joints). Merges
/// coincident vertices, which the file repeats along texture seams. Throws Error naming the file and its fault.
SkinnedMesh parse_hand_glb(const std::string& bytes, const std::string& source);

/// A hand: its mesh, and the poses of kPoseNames for this side, in the palm frame (`palm_frame`).
struct Hand {
  Side side = Side::Right;
  SkinnedMesh mesh;
  std::map<std::string, HandPose, std::less<>> poses;
  /// Throws Error that suggests the most similar known pose.
  const HandPose& pose(const std::string& name) const;
};

}  // namespace clothbench::assets

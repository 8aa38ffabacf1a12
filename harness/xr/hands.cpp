#include "xr/hands.hpp"

#include <algorithm>

namespace clothbench::xr {
namespace {

using assets::Side;

static_assert(assets::kRecordedJointCount == XR_HAND_JOINT_COUNT_EXT);
static_assert(std::extent_v<decltype(XrHandTrackingCapsulesStateFB::capsules)> == assets::kCapsuleCount);

/// Whether position and orientation are known.
bool is_known(XrSpaceLocationFlags flags) {
  constexpr XrSpaceLocationFlags kKnown =
      XR_SPACE_LOCATION_POSITION_VALID_BIT | XR_SPACE_LOCATION_ORIENTATION_VALID_BIT;
  return (flags & kKnown) == kKnown;
}

std::array<float, 3> three(const XrVector3f& v) { return {v.x, v.y, v.z}; }

assets::RecordedJoint joint(const XrPosef& p, float radius) {
  return {three(p.position), {p.orientation.x, p.orientation.y, p.orientation.z, p.orientation.w}, radius};
}

}  // namespace

Hands::Hands(const Session& session) : session_(session) {
  const Instance& xr = session.instance();
  capsules_ = xr.has(XR_FB_HAND_TRACKING_CAPSULES_EXTENSION_NAME);
  locate_ = xr.function<PFN_xrLocateHandJointsEXT>("xrLocateHandJointsEXT");
  const auto create = xr.function<PFN_xrCreateHandTrackerEXT>("xrCreateHandTrackerEXT");
  for (const Side side : {Side::Left, Side::Right}) {
    auto info = blank<XrHandTrackerCreateInfoEXT>(XR_TYPE_HAND_TRACKER_CREATE_INFO_EXT);
    info.hand = side == Side::Left ? XR_HAND_LEFT_EXT : XR_HAND_RIGHT_EXT;
    info.handJointSet = XR_HAND_JOINT_SET_DEFAULT_EXT;
    xr.check(create(session.handle(), &info, &trackers_[static_cast<std::size_t>(side)]), "xrCreateHandTrackerEXT");
  }
}

Hands::~Hands() {
  const auto destroy = session_.instance().function<PFN_xrDestroyHandTrackerEXT>("xrDestroyHandTrackerEXT");
  for (const XrHandTrackerEXT t : trackers_)
    if (t != XR_NULL_HANDLE) destroy(t);
}

std::optional<assets::RecordedHand> Hands::at(Side side, XrTime time) const {
  auto info = blank<XrHandJointsLocateInfoEXT>(XR_TYPE_HAND_JOINTS_LOCATE_INFO_EXT);
  info.baseSpace = session_.space();
  info.time = time;
  auto shapes = blank<XrHandTrackingCapsulesStateFB>(XR_TYPE_HAND_TRACKING_CAPSULES_STATE_FB);
  std::array<XrHandJointLocationEXT, XR_HAND_JOINT_COUNT_EXT> joints{};
  auto found = blank<XrHandJointLocationsEXT>(XR_TYPE_HAND_JOINT_LOCATIONS_EXT);
  // The headers of 1.0.20 chain this struct to the input; the specification chains it to the output.
  found.next = capsules_ ? &shapes : nullptr;
  found.jointCount = static_cast<std::uint32_t>(joints.size());
  found.jointLocations = joints.data();
  session_.instance().check(locate_(trackers_[static_cast<std::size_t>(side)], &info, &found), "xrLocateHandJointsEXT");
  if (found.isActive != XR_TRUE) return std::nullopt;
  assets::RecordedHand hand;
  for (std::size_t k = 0; k < joints.size(); ++k) {
    if (!is_known(joints[k].locationFlags)) return std::nullopt;
    hand.joints[k] = joint(joints[k].pose, joints[k].radius);
  }
  if (capsules_)
    for (std::size_t k = 0; k < hand.capsules.size(); ++k)
      hand.capsules[k] = {three(shapes.capsules[k].points[0]), three(shapes.capsules[k].points[1]),
                          shapes.capsules[k].radius};
  if (!assets::usable(hand)) return std::nullopt;
  return hand;
}

}  // namespace clothbench::xr

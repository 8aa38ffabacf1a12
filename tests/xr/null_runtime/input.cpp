// Spaces and hands.
#include "runtime.hpp"

namespace null_xr {
namespace {

XrResult XRAPI_CALL create_reference_space(XrSession, const XrReferenceSpaceCreateInfo* info, XrSpace* out) {
  Runtime& r = *runtime();
  if (info->referenceSpaceType != XR_REFERENCE_SPACE_TYPE_LOCAL)
    return r.fault("xrCreateReferenceSpace: another than LOCAL", XR_ERROR_REFERENCE_SPACE_UNSUPPORTED);
  *out = handle<XrSpace>(++r.handles);
  r.spaces[r.handles] = from_xr(info->poseInReferenceSpace);
  return XR_SUCCESS;
}

XrResult XRAPI_CALL destroy_space(XrSpace s) {
  return runtime()->spaces.erase(number_of(s)) == 1
             ? XR_SUCCESS
             : runtime()->fault("xrDestroySpace: no such space", XR_ERROR_HANDLE_INVALID);
}

XrResult XRAPI_CALL create_tracker(XrSession, const XrHandTrackerCreateInfoEXT* info, XrHandTrackerEXT* out) {
  ++runtime()->trackers;
  *out = handle<XrHandTrackerEXT>(info->hand == XR_HAND_RIGHT_EXT ? 21 : 20);
  return XR_SUCCESS;
}
XrResult XRAPI_CALL destroy_tracker(XrHandTrackerEXT) {
  --runtime()->trackers;
  return XR_SUCCESS;
}

bool seen(const Runtime& r) {
  const auto found = r.options.find("unseen");
  if (found == r.options.end()) return true;
  return !(r.frames >= std::stoi(found->second) &&
           r.frames < std::stoi(found->second.substr(found->second.find(':') + 1)));
}

XrResult XRAPI_CALL locate_joints(XrHandTrackerEXT tracker, const XrHandJointsLocateInfoEXT* info,
                                  XrHandJointLocationsEXT* out) {
  Runtime& r = *runtime();
  const auto base = r.spaces.find(number_of(info->baseSpace));
  if (base == r.spaces.end() || out->jointCount != XR_HAND_JOINT_COUNT_EXT)
    return r.fault("xrLocateHandJointsEXT: asked wrongly", XR_ERROR_VALIDATION_FAILURE);
  const bool right = number_of(tracker) == 21;
  const Pose palm = inverse(base->second) * Pose{{}, palm_at(right, r.seconds(info->time))};
  out->isActive = seen(r) ? XR_TRUE : XR_FALSE;
  const auto joint = joints(right);
  for (std::size_t k = 0; k < joint.size(); ++k) {
    XrHandJointLocationEXT& j = out->jointLocations[k];
    j.locationFlags = seen(r) ? XR_SPACE_LOCATION_POSITION_VALID_BIT | XR_SPACE_LOCATION_ORIENTATION_VALID_BIT : 0;
    j.pose = as_xr(palm * Pose{joint_turn(), joint[k]});
    j.radius = static_cast<float>(kJointRadius_m);
  }
  for (auto* next = static_cast<XrBaseOutStructure*>(out->next); next != nullptr; next = next->next) {
    if (next->type != XR_TYPE_HAND_TRACKING_CAPSULES_STATE_FB) continue;
    auto& state = *reinterpret_cast<XrHandTrackingCapsulesStateFB*>(next);
    const auto ends = capsule_joints();
    for (std::size_t k = 0; k < ends.size(); ++k) {
      for (std::size_t e = 0; e < 2; ++e) state.capsules[k].points[e] = out->jointLocations[ends[k][e]].pose.position;
      state.capsules[k].radius = static_cast<float>(kCapsuleRadius_m);
      state.capsules[k].joint = static_cast<XrHandJointEXT>(ends[k][0]);
    }
  }
  return XR_SUCCESS;
}

}  // namespace

PFN_xrVoidFunction input_function(const std::string& name) {
  NULL_XR("xrCreateReferenceSpace", create_reference_space)
  NULL_XR("xrDestroySpace", destroy_space)
  NULL_XR("xrCreateHandTrackerEXT", create_tracker)
  NULL_XR("xrDestroyHandTrackerEXT", destroy_tracker)
  NULL_XR("xrLocateHandJointsEXT", locate_joints)
  return nullptr;
}

}  // namespace null_xr

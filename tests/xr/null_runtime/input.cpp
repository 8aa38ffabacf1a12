// Spaces and hands.
#include <algorithm>
#include <cstring>

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

/// A closed box of 8 x 18 x 2.4 cm: its lower half follows the wrist, its upper half the middle finger. Every face has
/// vertices of its own, as where a texture is cut.
XrResult XRAPI_CALL hand_mesh(XrHandTrackerEXT tracker, XrHandTrackingMeshFB* m) {
  Mesh box;
  const V l{-0.04, -0.08, -0.012}, h{0.04, 0.1, 0.012}, s = h - l;
  add_face(box, {l.x, l.y, h.z}, {s.x, 0, 0}, {0, s.y, 0}, 3, 6);
  add_face(box, {h.x, l.y, l.z}, {-s.x, 0, 0}, {0, s.y, 0}, 3, 6);
  add_face(box, {h.x, l.y, h.z}, {0, 0, -s.z}, {0, s.y, 0}, 1, 6);
  add_face(box, {l.x, l.y, l.z}, {0, 0, s.z}, {0, s.y, 0}, 1, 6);
  add_face(box, {l.x, h.y, h.z}, {s.x, 0, 0}, {0, 0, -s.z}, 3, 1);
  add_face(box, {l.x, l.y, l.z}, {s.x, 0, 0}, {0, 0, s.z}, 3, 1);
  m->jointCountOutput = XR_HAND_JOINT_COUNT_EXT;
  m->vertexCountOutput = static_cast<std::uint32_t>(box.vertices.size());
  m->indexCountOutput = static_cast<std::uint32_t>(box.indices.size());
  if (m->jointCapacityInput == 0) return XR_SUCCESS;
  const auto joint = joints(number_of(tracker) == 21);
  for (std::size_t k = 0; k < joint.size(); ++k) {
    m->jointBindPoses[k] = as_xr({joint_turn(), joint[k]});
    m->jointRadii[k] = static_cast<float>(kJointRadius_m);
  }
  for (std::size_t v = 0; v < box.vertices.size(); ++v) {
    const V& p = box.vertices[v];
    // Rounded so that vertices meant to be one are one, bit for bit.
    const auto f = [](double x) { return static_cast<float>(std::round(x * 1e6) / 1e6); };
    m->vertexPositions[v] = {f(p.x), f(p.y), f(p.z)};
    m->vertexBlendIndices[v] = {static_cast<std::int16_t>(p.y < 0.01 ? 1 : 12), -1, -1, -1};
    m->vertexBlendWeights[v] = {1, 0, 0, 0};
  }
  for (std::size_t k = 0; k < box.indices.size(); ++k) m->indices[k] = static_cast<std::int16_t>(box.indices[k]);
  return XR_SUCCESS;
}

}  // namespace

PFN_xrVoidFunction input_function(const std::string& name) {
#define NULL_XR(text, function) \
  if (name == text) return reinterpret_cast<PFN_xrVoidFunction>(function);
  NULL_XR("xrCreateReferenceSpace", create_reference_space)
  NULL_XR("xrDestroySpace", destroy_space)
  NULL_XR("xrCreateHandTrackerEXT", create_tracker)
  NULL_XR("xrDestroyHandTrackerEXT", destroy_tracker)
  NULL_XR("xrLocateHandJointsEXT", locate_joints)
  NULL_XR("xrGetHandMeshFB", hand_mesh)
  return nullptr;
}

}  // namespace null_xr

// Spaces, hands, controllers and the room.
#include <algorithm>
#include <cstring>

#include "runtime.hpp"

namespace null_xr {
namespace {

namespace cb = clothbench::xr;

XrResult add_space(Space s, XrSpace* out) {
  Runtime& r = *runtime();
  *out = handle<XrSpace>(++r.handles);
  r.spaces[r.handles] = std::make_unique<Space>(std::move(s));
  return XR_SUCCESS;
}

XrResult XRAPI_CALL create_reference_space(XrSession, const XrReferenceSpaceCreateInfo* info, XrSpace* out) {
  const Pose origin{{}, {0, info->referenceSpaceType == XR_REFERENCE_SPACE_TYPE_STAGE ? -kEyeHeight_m : 0, 0}};
  return add_space({Space::Kind::Reference, origin * from_xr(info->poseInReferenceSpace), false}, out);
}

XrResult XRAPI_CALL create_action_space(XrSession, const XrActionSpaceCreateInfo* info, XrSpace* out) {
  return add_space({Space::Kind::Aim, {}, runtime()->paths.at(info->subactionPath) == "/user/hand/right"}, out);
}

XrResult XRAPI_CALL destroy_space(XrSpace s) {
  return runtime()->spaces.erase(number_of(s)) == 1
             ? XR_SUCCESS
             : runtime()->fault("xrDestroySpace: no such space", XR_ERROR_HANDLE_INVALID);
}

XrResult XRAPI_CALL locate_space(XrSpace s, XrSpace base, XrTime, XrSpaceLocation* out) {
  Runtime& r = *runtime();
  const auto what = r.spaces.find(number_of(s)), from = r.spaces.find(number_of(base));
  if (what == r.spaces.end() || from == r.spaces.end())
    return r.fault("xrLocateSpace: no such space", XR_ERROR_HANDLE_INVALID);
  // The left controller lies in a drawer.
  if (what->second->kind == Space::Kind::Aim && !what->second->right) return XR_SUCCESS;
  out->pose = as_xr(inverse(r.where(*from->second)) * r.where(*what->second));
  out->locationFlags = XR_SPACE_LOCATION_POSITION_VALID_BIT | XR_SPACE_LOCATION_ORIENTATION_VALID_BIT;
  return XR_SUCCESS;
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
  const Pose palm = inverse(r.where(*base->second)) * Pose{{}, palm_at(right, r.seconds(info->time))};
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

XrResult XRAPI_CALL create_action_set(XrInstance, const XrActionSetCreateInfo*, XrActionSet* out) {
  *out = handle<XrActionSet>(5);
  return XR_SUCCESS;
}
XrResult XRAPI_CALL destroy_action_set(XrActionSet) { return XR_SUCCESS; }
XrResult XRAPI_CALL create_action(XrActionSet, const XrActionCreateInfo*, XrAction* out) {
  *out = handle<XrAction>(++runtime()->handles);
  return XR_SUCCESS;
}
XrResult XRAPI_CALL suggest_bindings(XrInstance, const XrInteractionProfileSuggestedBinding* info) {
  Runtime& r = *runtime();
  if (r.paths.at(info->interactionProfile) != "/interaction_profiles/oculus/touch_controller") return XR_SUCCESS;
  for (std::uint32_t k = 0; k < info->countSuggestedBindings; ++k)
    r.bindings[number_of(info->suggestedBindings[k].action)].push_back(r.paths.at(info->suggestedBindings[k].binding));
  return XR_SUCCESS;
}
XrResult XRAPI_CALL attach(XrSession, const XrSessionActionSetsAttachInfo*) { return XR_SUCCESS; }
XrResult XRAPI_CALL sync_actions(XrSession, const XrActionsSyncInfo*) {
  runtime()->synced_frame = runtime()->frames;
  return XR_SUCCESS;
}
bool bound(const Runtime& r, XrAction action, const char* to) {
  const auto found = r.bindings.find(number_of(action));
  return found != r.bindings.end() && std::find(found->second.begin(), found->second.end(), to) != found->second.end();
}
XrResult XRAPI_CALL boolean_state(XrSession, const XrActionStateGetInfo* info, XrActionStateBoolean* out) {
  Runtime& r = *runtime();
  out->isActive = XR_TRUE;
  out->currentState =
      bound(r, info->action, "/user/hand/right/input/a/click") && shows_room(r.synced_frame) ? XR_TRUE : XR_FALSE;
  return XR_SUCCESS;
}
XrResult XRAPI_CALL float_state(XrSession, const XrActionStateGetInfo* info, XrActionStateFloat* out) {
  Runtime& r = *runtime();
  const bool right = r.paths.at(info->subactionPath) == "/user/hand/right";
  out->isActive = right ? XR_TRUE : XR_FALSE;
  out->currentState =
      right && bound(r, info->action, "/user/hand/right/input/trigger/value") && pulls(r.synced_frame) ? 0.9f : 0.1f;
  return XR_SUCCESS;
}

XrResult XRAPI_CALL query_spaces(XrSession, const cb::SpaceQuery* info, cb::RequestId* id) {
  Runtime& r = *runtime();
  const auto* filter = static_cast<const cb::SpaceComponentFilter*>(info->filter);
  if (info->type != cb::kTypeSpaceQuery || filter == nullptr || filter->component != cb::kComponentTriangleMesh)
    return r.fault("xrQuerySpacesFB: asked for something else", XR_ERROR_VALIDATION_FAILURE);
  *id = 77;
  XrEventDataBuffer event{};
  auto& available = reinterpret_cast<cb::EventSpaceQueryAvailable&>(event);
  available = {cb::kTypeSpaceQueryAvailable, nullptr, 77};
  if (r.number("room", 1) != 2) r.events.push_back(event);
  reinterpret_cast<cb::EventSpaceQueryComplete&>(event) = {cb::kTypeSpaceQueryComplete, nullptr, 77, XR_SUCCESS};
  r.events.push_back(event);
  return XR_SUCCESS;
}
XrResult XRAPI_CALL query_results(XrSession, cb::RequestId, cb::SpaceQueryResults* out) {
  out->count = 1;
  if (out->capacity == 0) return XR_SUCCESS;
  for (std::uint8_t k = 0; k < 16; ++k) out->results[0].uuid.data[k] = k;
  return add_space({Space::Kind::Room, {}, false}, &out->results[0].space);
}
/// Enabled once it was asked for.
bool room_located = false;
XrResult XRAPI_CALL component_status(XrSpace, int, cb::ComponentStatus* out) {
  out->enabled = room_located ? XR_TRUE : XR_FALSE;
  out->change_pending = XR_FALSE;
  return XR_SUCCESS;
}
XrResult XRAPI_CALL set_component_status(XrSpace, const cb::ComponentStatusSet* info, cb::RequestId* id) {
  *id = 78;
  room_located = info->component == cb::kComponentLocatable && info->enabled == XR_TRUE;
  return XR_SUCCESS;
}
XrResult XRAPI_CALL triangle_mesh(XrSpace, const cb::TriangleMeshGetInfo*, cb::TriangleMeshOutput* out) {
  const Mesh m = room();
  out->vertex_count = static_cast<std::uint32_t>(m.vertices.size());
  out->index_count = static_cast<std::uint32_t>(m.indices.size());
  if (out->vertex_capacity == 0) return XR_SUCCESS;
  for (std::size_t v = 0; v < m.vertices.size(); ++v) {
    const Pose p = inverse(room_pose()) * Pose{{}, m.vertices[v]};
    out->vertices[v] = as_xr(p).position;
  }
  std::copy(m.indices.begin(), m.indices.end(), out->indices);
  return XR_SUCCESS;
}

}  // namespace

PFN_xrVoidFunction input_function(const std::string& name) {
#define NULL_XR(text, function) \
  if (name == text) return reinterpret_cast<PFN_xrVoidFunction>(function);
  NULL_XR("xrCreateReferenceSpace", create_reference_space)
  NULL_XR("xrCreateActionSpace", create_action_space)
  NULL_XR("xrDestroySpace", destroy_space)
  NULL_XR("xrLocateSpace", locate_space)
  NULL_XR("xrCreateHandTrackerEXT", create_tracker)
  NULL_XR("xrDestroyHandTrackerEXT", destroy_tracker)
  NULL_XR("xrLocateHandJointsEXT", locate_joints)
  NULL_XR("xrGetHandMeshFB", hand_mesh)
  NULL_XR("xrCreateActionSet", create_action_set)
  NULL_XR("xrDestroyActionSet", destroy_action_set)
  NULL_XR("xrCreateAction", create_action)
  NULL_XR("xrSuggestInteractionProfileBindings", suggest_bindings)
  NULL_XR("xrAttachSessionActionSets", attach)
  NULL_XR("xrSyncActions", sync_actions)
  NULL_XR("xrGetActionStateBoolean", boolean_state)
  NULL_XR("xrGetActionStateFloat", float_state)
  NULL_XR("xrQuerySpacesFB", query_spaces)
  NULL_XR("xrRetrieveSpaceQueryResultsFB", query_results)
  NULL_XR("xrGetSpaceComponentStatusFB", component_status)
  NULL_XR("xrSetSpaceComponentStatusFB", set_component_status)
  NULL_XR("xrGetSpaceTriangleMeshMETA", triangle_mesh)
  return nullptr;
}

}  // namespace null_xr

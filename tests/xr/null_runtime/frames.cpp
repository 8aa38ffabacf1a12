// Session, clock, composition, spaces and hands.
#include <sstream>

#include "runtime.hpp"

namespace null_xr {
namespace {

namespace cb = clothbench::xr;

XrResult XRAPI_CALL blend_modes(XrInstance, XrSystemId, XrViewConfigurationType, std::uint32_t capacity,
                                std::uint32_t* count, XrEnvironmentBlendMode* out) {
  return list<XrEnvironmentBlendMode>({XR_ENVIRONMENT_BLEND_MODE_OPAQUE}, capacity, count, out);
}

XrResult XRAPI_CALL configuration_views(XrInstance, XrSystemId, XrViewConfigurationType type, std::uint32_t capacity,
                                        std::uint32_t* count, XrViewConfigurationView* out) {
  if (type != XR_VIEW_CONFIGURATION_TYPE_PRIMARY_STEREO) return XR_ERROR_VIEW_CONFIGURATION_TYPE_UNSUPPORTED;
  const XrViewConfigurationView eye{XR_TYPE_VIEW_CONFIGURATION_VIEW, nullptr, 64, 128, 72, 128, 1, 4};
  return list<XrViewConfigurationView>({eye, eye}, capacity, count, out);
}

XrResult XRAPI_CALL begin_session(XrSession, const XrSessionBeginInfo*) {
  Runtime& r = *runtime();
  if (r.running) return r.fault("xrBeginSession: it runs", XR_ERROR_SESSION_RUNNING);
  if (r.state != XR_SESSION_STATE_READY) return r.fault("xrBeginSession: not ready", XR_ERROR_SESSION_NOT_READY);
  r.running = true;
  for (const auto s : {XR_SESSION_STATE_SYNCHRONIZED, XR_SESSION_STATE_VISIBLE, XR_SESSION_STATE_FOCUSED}) r.go(s);
  return XR_SUCCESS;
}

void stop(Runtime& r) {
  for (const auto s : {XR_SESSION_STATE_VISIBLE, XR_SESSION_STATE_SYNCHRONIZED, XR_SESSION_STATE_STOPPING}) r.go(s);
}

XrResult XRAPI_CALL request_exit(XrSession) {
  Runtime& r = *runtime();
  if (!r.running) return r.fault("xrRequestExitSession: it does not run", XR_ERROR_SESSION_NOT_RUNNING);
  if (r.state != XR_SESSION_STATE_STOPPING) stop(r);
  return XR_SUCCESS;
}

XrResult XRAPI_CALL end_session(XrSession) {
  Runtime& r = *runtime();
  if (r.state != XR_SESSION_STATE_STOPPING) return r.fault("xrEndSession: not stopping", XR_ERROR_SESSION_NOT_STOPPING);
  r.running = false;
  r.go(XR_SESSION_STATE_IDLE);
  r.go(XR_SESSION_STATE_EXITING);
  return XR_SUCCESS;
}

/// Seconds by which the application counts as late after this many frames.
double stall_s(const Runtime& r, int frames) {
  const auto found = r.options.find("stalls");
  std::istringstream in(found == r.options.end() ? "" : found->second);
  for (std::string item; std::getline(in, item, ';');) {
    const auto colon = item.find(':');
    if (colon != std::string::npos && std::stoi(item) == frames) return std::stod(item.substr(colon + 1));
  }
  return 0;
}

/// A strict display: a frame that took longer than a period is shown after the next whole number of periods.
XrResult XRAPI_CALL wait_frame(XrSession, const XrFrameWaitInfo*, XrFrameState* out) {
  Runtime& r = *runtime();
  if (!r.running) return r.fault("xrWaitFrame: it does not run", XR_ERROR_SESSION_NOT_RUNNING);
  if (r.waited) return r.fault("xrWaitFrame: the frame before was not begun", XR_ERROR_CALL_ORDER_INVALID);
  if (r.frames == 4) r.rate_hz = r.next_rate_hz;  // not at once
  const XrDuration period = r.period_ns();
  const XrDuration took = 1 + static_cast<XrDuration>(stall_s(r, r.ended) * 1e9);
  r.wake_ns += (took + period - 1) / period * period;
  r.waited = true;
  ++r.frames;
  out->predictedDisplayTime = r.wake_ns + 2 * period;
  out->predictedDisplayPeriod = r.frames > 5 ? period * static_cast<XrDuration>(r.number("multiple", 1)) : period;
  const bool seen = r.state == XR_SESSION_STATE_VISIBLE || r.state == XR_SESSION_STATE_FOCUSED;
  out->shouldRender = seen && r.number("blind", 0) == 0 ? XR_TRUE : XR_FALSE;
  if (r.frames == static_cast<int>(r.number("quit", -1))) stop(r);
  return XR_SUCCESS;
}

XrResult XRAPI_CALL begin_frame(XrSession, const XrFrameBeginInfo*) {
  Runtime& r = *runtime();
  if (!r.waited) return r.fault("xrBeginFrame: not waited for", XR_ERROR_CALL_ORDER_INVALID);
  if (r.begun) r.faults.push_back("xrBeginFrame: the frame before was not ended");
  r.waited = false;
  r.begun = true;
  return XR_SUCCESS;
}

XrResult judge_projection(Runtime& r, const XrCompositionLayerProjection& layer) {
  ++r.projection_frames;
  if (layer.viewCount != 2)
    return r.fault("xrEndFrame: a projection layer of other than 2 views", XR_ERROR_VALIDATION_FAILURE);
  if (!r.spaces.contains(number_of(layer.space))) return r.fault("xrEndFrame: no such space", XR_ERROR_HANDLE_INVALID);
  for (std::uint32_t k = 0; k < 2; ++k) {
    const XrCompositionLayerProjectionView& v = layer.views[k];
    const auto found = r.swapchains.find(number_of(v.subImage.swapchain));
    if (found == r.swapchains.end()) return r.fault("xrEndFrame: no such swapchain", XR_ERROR_HANDLE_INVALID);
    const Swapchain& images = *found->second;
    if (images.acquired != ~0u || images.released == ~0u)
      return r.fault("xrEndFrame: an image was not released", XR_ERROR_LAYER_INVALID);
    const auto& rect = v.subImage.imageRect;
    if (rect.offset.x < 0 || rect.offset.y < 0 || rect.extent.width <= 0 || rect.extent.height <= 0 ||
        rect.offset.x + rect.extent.width > static_cast<int>(images.extent.width) ||
        rect.offset.y + rect.extent.height > static_cast<int>(images.extent.height))
      return r.fault("xrEndFrame: a rectangle outside its image", XR_ERROR_SWAPCHAIN_RECT_INVALID);
    if (r.frames == static_cast<int>(r.number("look", -1))) r.drawn[k] = drawn_share(r, images);
  }
  return XR_SUCCESS;
}

XrResult XRAPI_CALL end_frame(XrSession, const XrFrameEndInfo* info) {
  Runtime& r = *runtime();
  if (!r.begun) return r.fault("xrEndFrame: not begun", XR_ERROR_CALL_ORDER_INVALID);
  r.begun = false;
  ++r.ended;
  if (info->displayTime != r.wake_ns + 2 * r.period_ns())
    return r.fault("xrEndFrame: another display time", XR_ERROR_TIME_INVALID);
  for (std::uint32_t k = 0; k < info->layerCount; ++k) {
    const XrCompositionLayerBaseHeader* layer = info->layers[k];
    if (layer->type != XR_TYPE_COMPOSITION_LAYER_PROJECTION)
      return r.fault("xrEndFrame: a layer of another kind", XR_ERROR_LAYER_INVALID);
    const XrResult result = judge_projection(r, *reinterpret_cast<const XrCompositionLayerProjection*>(layer));
    if (XR_FAILED(result)) return result;
  }
  return XR_SUCCESS;
}

/// Two eyes 63 mm apart that look along -z from the head's initial position.
XrResult XRAPI_CALL locate_views(XrSession, const XrViewLocateInfo* info, XrViewState* state, std::uint32_t capacity,
                                 std::uint32_t* count, XrView* out) {
  Runtime& r = *runtime();
  *count = 2;
  if (capacity == 0) return XR_SUCCESS;
  const auto base = r.spaces.find(number_of(info->space));
  if (base == r.spaces.end()) return r.fault("xrLocateViews: no such space", XR_ERROR_HANDLE_INVALID);
  state->viewStateFlags = XR_VIEW_STATE_POSITION_VALID_BIT | XR_VIEW_STATE_ORIENTATION_VALID_BIT;
  for (int k = 0; k < 2; ++k) {
    out[k].pose = as_xr(inverse(base->second) * Pose{{}, {k == 0 ? -0.0315 : 0.0315, 0, 0}});
    const float outward = 0.94f, inward = 0.7f;  // rad
    out[k].fov = {k == 0 ? -outward : -inward, k == 0 ? inward : outward, 0.83f, -0.84f};
  }
  return XR_SUCCESS;
}

XrResult XRAPI_CALL request_rate(XrSession, float rate) {
  for (const float there : {72.f, 80.f, 90.f, 120.f})
    if (rate == there) {
      runtime()->next_rate_hz = static_cast<double>(rate);
      return XR_SUCCESS;
    }
  return XR_ERROR_DISPLAY_REFRESH_RATE_UNSUPPORTED_FB;
}

/// The kind of performance counters that is enabled: the first if both are.
const cb::Metrics& metrics() { return cb::kMetrics[runtime()->enabled.contains(cb::kMetrics[0].extension) ? 0 : 1]; }

XrResult XRAPI_CALL enumerate_counters(XrInstance, std::uint32_t capacity, std::uint32_t* count, XrPath* out) {
  ++runtime()->counter_calls;
  return list<XrPath>({1, 2, 3, 4, 5}, capacity, count, out);
}

XrResult XRAPI_CALL path_to_string(XrInstance, XrPath path, std::uint32_t, std::uint32_t* count, char* out) {
  *count = static_cast<std::uint32_t>(
      std::sprintf(out, "/perfmetrics_%s/%s", metrics().suffix, kCounters.at(path - 1).path) + 1);
  return XR_SUCCESS;
}

XrResult XRAPI_CALL set_metrics(XrSession, const cb::Block<0>* state) {
  Runtime& r = *runtime();
  ++r.counter_calls;
  if (state->type != metrics().state || !r.running)
    return r.fault("xrSetPerformanceMetricsState: asked wrongly", XR_ERROR_VALIDATION_FAILURE);
  r.measures = state->number == XR_TRUE;
  return XR_SUCCESS;
}

XrResult XRAPI_CALL query_counter(XrSession, XrPath path, cb::MetricsCounter* out) {
  Runtime& r = *runtime();
  ++r.counter_calls;
  if (out->type != metrics().counter || !r.measures)
    return r.fault("xrQueryPerformanceMetricsCounter: asked wrongly", XR_ERROR_VALIDATION_FAILURE);
  const Counter& c = kCounters.at(path - 1);
  out->flags = c.flags;
  out->unit = c.unit;
  out->whole = static_cast<std::uint32_t>(r.frames);
  out->real = 0.5f * static_cast<float>(r.frames);
  return r.within("unmeasured") ? XR_ERROR_RUNTIME_FAILURE : XR_SUCCESS;  // its output is then undefined
}

XrResult XRAPI_CALL create_reference_space(XrSession, const XrReferenceSpaceCreateInfo* info, XrSpace* out) {
  Runtime& r = *runtime();
  if (info->referenceSpaceType != XR_REFERENCE_SPACE_TYPE_LOCAL)
    return r.fault("xrCreateReferenceSpace: another than LOCAL", XR_ERROR_REFERENCE_SPACE_UNSUPPORTED);
  *out = handle<XrSpace>(++r.handles);
  r.spaces[r.handles] = r.space = from_xr(info->poseInReferenceSpace);
  return XR_SUCCESS;
}

XrResult XRAPI_CALL destroy_space(XrSpace s) {
  return runtime()->spaces.erase(number_of(s)) == 1
             ? XR_SUCCESS
             : runtime()->fault("xrDestroySpace: no such space", XR_ERROR_HANDLE_INVALID);
}

/// Begins to create a context or a snapshot of planes.
XrResult XRAPI_CALL search_planes(void*, const cb::Block<0>* info, const void** future) {
  Runtime& r = *runtime();
  ++r.plane_calls;
  const bool context = info->type == XrStructureType(1000740001);
  const auto& wanted = context ? **static_cast<const cb::Block<0>* const*>(info->data) : *info;
  const bool with_labels = (context ? static_cast<int>(wanted.count) : wanted.number) > 2;
  if (with_labels && r.number("labels", 1) == 0) return cb::kComponentUnsupported;
  r.planes_ready = r.frames + 3;
  *future = &r;
  return XR_SUCCESS;
}

/// Completes it; `info` is the future or a structure.
XrResult XRAPI_CALL complete_planes(void*, const cb::SnapshotCompletionInfo* info, cb::Block<0>* done) {
  Runtime& r = *runtime();
  if (r.frames < r.planes_ready) return cb::kFuturePending;
  if (done->type == XrStructureType(1000740005)) r.base = r.spaces.at(number_of(info->base));
  ++r.plane_handles;
  done->data = &r;
  return XR_SUCCESS;
}

XrResult XRAPI_CALL destroy_planes(void*) { return --runtime()->plane_handles, XR_SUCCESS; }

XrResult XRAPI_CALL query_planes(void*, const cb::Block<0>*, cb::QueryResult* out) {
  const Runtime& r = *runtime();
  out->id_count = r.number("planes", 0) == 2 ? 3 : 4;
  for (std::size_t k = 0; k < out->id_count; ++k) {
    const auto& [pose, width_m, height_m, alignment, label, state] = kSurroundings.at(k);
    const XrExtent2Df size{static_cast<float>(width_m), static_cast<float>(height_m)};
    out->states[k] = state;
    for (auto* list = static_cast<const cb::Block<0>*>(out->next); list != nullptr;
         list = static_cast<const cb::Block<0>*>(list->next)) {
      auto* data = const_cast<void*>(list->data);
      if (list->type == XrStructureType(1000740009))
        static_cast<cb::Bounds2D*>(data)[k] = {as_xr(inverse(r.base) * pose), size};
      else
        static_cast<int*>(data)[k] = list->type == XrStructureType(1000741001) ? alignment : label;
    }
  }
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

bool seen(const Runtime& r) { return !r.within("unseen"); }

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

PFN_xrVoidFunction frame_function(const std::string& name) {
  if (runtime() == nullptr) return nullptr;
  NULL_XR("xrEnumerateEnvironmentBlendModes", blend_modes)
  NULL_XR("xrEnumerateViewConfigurationViews", configuration_views)
  NULL_XR("xrBeginSession", begin_session)
  NULL_XR("xrRequestExitSession", request_exit)
  NULL_XR("xrEndSession", end_session)
  NULL_XR("xrWaitFrame", wait_frame)
  NULL_XR("xrBeginFrame", begin_frame)
  NULL_XR("xrEndFrame", end_frame)
  NULL_XR("xrLocateViews", locate_views)
  NULL_XR("xrRequestDisplayRefreshRateFB", request_rate)
  NULL_XR("xrPathToString", path_to_string)
  NULL_XR("xrCreateSpatialContextAsyncEXT", search_planes)
  NULL_XR("xrCreateSpatialContextCompleteEXT", complete_planes)
  NULL_XR("xrCreateSpatialDiscoverySnapshotAsyncEXT", search_planes)
  NULL_XR("xrCreateSpatialDiscoverySnapshotCompleteEXT", complete_planes)
  NULL_XR("xrDestroySpatialContextEXT", destroy_planes)
  NULL_XR("xrDestroySpatialSnapshotEXT", destroy_planes)
  NULL_XR("xrQuerySpatialComponentDataEXT", query_planes)
  NULL_XR(std::string("xrEnumeratePerformanceMetricsCounterPaths") + metrics().suffix, enumerate_counters)
  NULL_XR(std::string("xrSetPerformanceMetricsState") + metrics().suffix, set_metrics)
  NULL_XR(std::string("xrQueryPerformanceMetricsCounter") + metrics().suffix, query_counter)
  NULL_XR("xrCreateReferenceSpace", create_reference_space)
  NULL_XR("xrDestroySpace", destroy_space)
  NULL_XR("xrCreateHandTrackerEXT", create_tracker)
  NULL_XR("xrDestroyHandTrackerEXT", destroy_tracker)
  NULL_XR("xrLocateHandJointsEXT", locate_joints)
  return nullptr;
}

}  // namespace null_xr

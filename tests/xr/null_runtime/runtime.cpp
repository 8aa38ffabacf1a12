#include "runtime.hpp"

#include <cstdlib>
#include <cstring>
#include <fstream>
#include <nlohmann/json.hpp>
#include <sstream>

namespace null_xr {
/// The data that loader and runtime exchange (chapter "Loader Design", runtime negotiation).
struct NegotiateLoaderInfo {
  int struct_type = 1;
  std::uint32_t struct_version = 1;
  std::size_t struct_size = sizeof(NegotiateLoaderInfo);
  std::uint32_t min_interface = 1, max_interface = 1;
  XrVersion min_api = XR_MAKE_VERSION(1, 0, 0), max_api = XR_MAKE_VERSION(1, 0x3ff, 0xfff);
};
struct NegotiateRuntimeRequest {
  int struct_type = 3;
  std::uint32_t struct_version = 1;
  std::size_t struct_size = sizeof(NegotiateRuntimeRequest);
  std::uint32_t interface_version = 0;
  XrVersion api_version = 0;
  PFN_xrGetInstanceProcAddr get_instance_proc_addr = nullptr;
};

namespace {

namespace cb = clothbench::xr;

std::unique_ptr<Runtime>& held() {
  static std::unique_ptr<Runtime> r;
  return r;
}

struct Offer {
  const char *extension, *key;
  double unless_told = 1;
};
bool offers(const Runtime& r, const Offer& o) { return r.number(o.key, o.unless_told) != 0; }

constexpr Offer kOffers[] = {{XR_KHR_VULKAN_ENABLE2_EXTENSION_NAME, "vulkan"},
                             {XR_FB_DISPLAY_REFRESH_RATE_EXTENSION_NAME, "rate"},
                             {XR_EXT_HAND_TRACKING_EXTENSION_NAME, "hands"},
                             {XR_FB_HAND_TRACKING_CAPSULES_EXTENSION_NAME, "capsules"},
                             {cb::kMetrics[0].extension, "ANDROID", 0},
                             {cb::kMetrics[1].extension, "META", 0},
                             {cb::kPlanes[0], "planes", 0},
                             {cb::kPlanes[1], "planes", 0},
                             {cb::kPlanes[2], "planes", 0},
                             {"XR_KHR_android_create_instance", "android"}};

XrResult XRAPI_CALL enumerate_extensions(const char* layer, std::uint32_t capacity, std::uint32_t* count,
                                         XrExtensionProperties* out) {
  if (layer != nullptr) return XR_ERROR_API_LAYER_NOT_PRESENT;
  const Runtime options;  // an instance need not be there
  std::vector<XrExtensionProperties> offered;
  for (const Offer& o : kOffers) {
    if (!offers(options, o)) continue;
    std::strcpy(offered.emplace_back(XrExtensionProperties{XR_TYPE_EXTENSION_PROPERTIES, nullptr, "", 1}).extensionName,
                o.extension);
  }
  return list(offered, capacity, count, out);
}

XrResult XRAPI_CALL create_instance(const XrInstanceCreateInfo* info, XrInstance* out) {
  if (runtime() != nullptr) return XR_ERROR_LIMIT_REACHED;
  auto made = std::make_unique<Runtime>();
  for (std::uint32_t k = 0; k < info->enabledExtensionCount; ++k) {
    bool known = false;
    for (const Offer& o : kOffers)
      known = known || (std::strcmp(o.extension, info->enabledExtensionNames[k]) == 0 && offers(*made, o));
    if (!known) return XR_ERROR_EXTENSION_NOT_PRESENT;
    made->enabled.insert(info->enabledExtensionNames[k]);
  }
  // The activity's data that XR_KHR_android_create_instance requires.
  const auto* android = static_cast<const cb::AndroidInfo*>(info->next);
  if (android != nullptr &&
      (android->type != cb::kTypeInstanceCreateAndroid || android->vm == nullptr || android->activity == nullptr))
    return XR_ERROR_VALIDATION_FAILURE;
  made->android = android != nullptr;
  held() = std::move(made);
  *out = handle<XrInstance>(1);
  return XR_SUCCESS;
}

XrResult XRAPI_CALL destroy_instance(XrInstance) {
  Runtime& r = *runtime();
  if (r.session) r.faults.push_back("the instance is destroyed before the session");
  if (!r.spaces.empty()) r.faults.push_back("spaces are left");
  if (!r.swapchains.empty()) r.faults.push_back("swapchains are left");
  if (r.plane_handles != 0) r.faults.push_back("spatial contexts or snapshots are left");
  if (r.trackers != 0) r.faults.push_back("hand trackers are left");
  const auto log = r.options.find("log");
  if (log != r.options.end()) {
    nlohmann::json j = {{"frames", r.ended}, {"rate_hz", r.rate_hz}, {"projection_frames", r.projection_frames},
                        {"drawn", r.drawn},  {"android", r.android}, {"faults", r.faults}};
    j.update({{"counter_calls", r.counter_calls}, {"plane_calls", r.plane_calls}});
    j["space"] = {r.space.p.x, r.space.p.y, r.space.p.z};
    std::ofstream(log->second) << j.dump(1) << "\n";
  }
  held() = nullptr;
  return XR_SUCCESS;
}

XrResult XRAPI_CALL instance_properties(XrInstance, XrInstanceProperties* p) {
  std::strcpy(p->runtimeName, "clothbench null runtime");
  p->runtimeVersion = XR_MAKE_VERSION(1, 0, 0);
  return XR_SUCCESS;
}

XrResult XRAPI_CALL poll_event(XrInstance, XrEventDataBuffer* out) {
  Runtime& r = *runtime();
  if (r.events.empty()) return XR_EVENT_UNAVAILABLE;
  *out = r.events.front();
  r.events.pop_front();
  return XR_SUCCESS;
}

XrResult XRAPI_CALL result_to_string(XrInstance, XrResult result, char* text) {
  std::snprintf(text, XR_MAX_RESULT_STRING_SIZE, "XrResult %d", static_cast<int>(result));
  return XR_SUCCESS;
}

XrResult XRAPI_CALL get_system(XrInstance, const XrSystemGetInfo* info, XrSystemId* id) {
  if (info->formFactor != XR_FORM_FACTOR_HEAD_MOUNTED_DISPLAY) return XR_ERROR_FORM_FACTOR_UNSUPPORTED;
  *id = 7;
  return XR_SUCCESS;
}

XrResult XRAPI_CALL system_properties(XrInstance, XrSystemId, XrSystemProperties* p) {
  std::strcpy(p->systemName, "null headset");
  for (auto* next = static_cast<XrBaseOutStructure*>(p->next); next != nullptr; next = next->next)
    if (next->type == XR_TYPE_SYSTEM_HAND_TRACKING_PROPERTIES_EXT)
      reinterpret_cast<XrSystemHandTrackingPropertiesEXT*>(next)->supportsHandTracking = XR_TRUE;
  return XR_SUCCESS;
}

XrResult XRAPI_CALL get_instance_proc_addr(XrInstance, const char* name, PFN_xrVoidFunction* out) {
  const std::map<std::string, PFN_xrVoidFunction> own = {
#define NULL_XR_ENTRY(name, function) {name, reinterpret_cast<PFN_xrVoidFunction>(function)}
      NULL_XR_ENTRY("xrGetInstanceProcAddr", get_instance_proc_addr),
      NULL_XR_ENTRY("xrEnumerateInstanceExtensionProperties", enumerate_extensions),
      NULL_XR_ENTRY("xrCreateInstance", create_instance),
      NULL_XR_ENTRY("xrDestroyInstance", destroy_instance),
      NULL_XR_ENTRY("xrGetInstanceProperties", instance_properties),
      NULL_XR_ENTRY("xrPollEvent", poll_event),
      NULL_XR_ENTRY("xrResultToString", result_to_string),
      NULL_XR_ENTRY("xrGetSystem", get_system),
      NULL_XR_ENTRY("xrGetSystemProperties", system_properties)};
  const auto found = own.find(name);
  *out = found != own.end() ? found->second : nullptr;
  for (const auto find : {frame_function, graphics_function})
    if (*out == nullptr) *out = find(name);
  return *out != nullptr ? XR_SUCCESS : XR_ERROR_FUNCTION_UNSUPPORTED;
}

}  // namespace

Runtime* runtime() { return held().get(); }

Runtime::Runtime() {
  const char* text = std::getenv("CLOTHBENCH_NULL_XR");
  std::istringstream in(text != nullptr ? text : "");
  for (std::string item; std::getline(in, item, ',');) {
    const auto eq = item.find('=');
    if (eq != std::string::npos) options[item.substr(0, eq)] = item.substr(eq + 1);
  }
}

double Runtime::number(const std::string& key, double otherwise) const {
  const auto found = options.find(key);
  return found == options.end() ? otherwise : std::strtod(found->second.c_str(), nullptr);
}

bool Runtime::within(const std::string& key) const {
  const auto found = options.find(key);
  return found != options.end() && frames >= std::stoi(found->second) &&
         frames < std::stoi(found->second.substr(found->second.find(':') + 1));
}

void Runtime::go(XrSessionState to) {
  state = to;
  XrEventDataBuffer event{};
  auto& changed = reinterpret_cast<XrEventDataSessionStateChanged&>(event);
  changed.type = XR_TYPE_EVENT_DATA_SESSION_STATE_CHANGED;
  changed.session = handle<XrSession>(2);
  changed.state = to;
  events.push_back(event);
}

XrPosef as_xr(const Pose& p) {
  const auto f = [](double x) { return static_cast<float>(x); };
  return {{f(p.q.x), f(p.q.y), f(p.q.z), f(p.q.w)}, {f(p.p.x), f(p.p.y), f(p.p.z)}};
}

Pose from_xr(const XrPosef& p) {
  return {{p.orientation.x, p.orientation.y, p.orientation.z, p.orientation.w},
          {p.position.x, p.position.y, p.position.z}};
}

}  // namespace null_xr

extern "C" __attribute__((visibility("default"))) XrResult xrNegotiateLoaderRuntimeInterface(
    const null_xr::NegotiateLoaderInfo* loader, null_xr::NegotiateRuntimeRequest* request) {
  if (loader->min_interface > 1 || loader->max_interface < 1) return XR_ERROR_INITIALIZATION_FAILED;
  request->interface_version = 1;
  request->api_version = XR_MAKE_VERSION(1, 0, 20);
  request->get_instance_proc_addr = null_xr::get_instance_proc_addr;
  return XR_SUCCESS;
}

#include "xr/instance.hpp"

#include <dlfcn.h>
#include <fmt/format.h>

#include <array>

#include "clothbench/error.hpp"

namespace clothbench::xr {
namespace {

AndroidContext& context() {
  static AndroidContext c;
  return c;
}

constexpr const char* kAndroidCreate = "XR_KHR_android_create_instance";
/// Extensions used if present. The required one, XR_KHR_vulkan_enable2, is not in this list.
constexpr std::array kWelcome = {XR_FB_DISPLAY_REFRESH_RATE_EXTENSION_NAME,
                                 XR_EXT_HAND_TRACKING_EXTENSION_NAME,
                                 XR_FB_HAND_TRACKING_CAPSULES_EXTENSION_NAME,
                                 kMetrics[0].extension,
                                 kMetrics[1].extension,
                                 "XR_KHR_maintenance1",
                                 kPlanes[0],
                                 kPlanes[1],
                                 kPlanes[2]};

/// XR_KHR_vulkan_enable2: the runtime creates Vulkan objects from our requests and its own.
class RuntimeMaker : public vulkan::Maker {
 public:
  explicit RuntimeMaker(const Instance& xr) : xr_(xr) {}

  VkResult create_instance(const VkInstanceCreateInfo& wanted, VkInstance* made) override {
    auto info = blank<XrVulkanInstanceCreateInfoKHR>(XR_TYPE_VULKAN_INSTANCE_CREATE_INFO_KHR);
    info.systemId = xr_.system();
    info.pfnGetInstanceProcAddr = vkGetInstanceProcAddr;
    info.vulkanCreateInfo = &wanted;
    VkResult result = VK_SUCCESS;
    xr_.check(xr_.xr().xrCreateVulkanInstanceKHR(xr_.handle(), &info, made, &result), "xrCreateVulkanInstanceKHR");
    return result;
  }

  VkPhysicalDevice physical_device(VkInstance instance) override {
    auto info = blank<XrVulkanGraphicsDeviceGetInfoKHR>(XR_TYPE_VULKAN_GRAPHICS_DEVICE_GET_INFO_KHR);
    info.systemId = xr_.system();
    info.vulkanInstance = instance;
    VkPhysicalDevice found = VK_NULL_HANDLE;
    xr_.check(xr_.xr().xrGetVulkanGraphicsDevice2KHR(xr_.handle(), &info, &found), "xrGetVulkanGraphicsDevice2KHR");
    return found;
  }

  VkResult create_device(VkPhysicalDevice physical, const VkDeviceCreateInfo& wanted, VkDevice* made) override {
    auto info = blank<XrVulkanDeviceCreateInfoKHR>(XR_TYPE_VULKAN_DEVICE_CREATE_INFO_KHR);
    info.systemId = xr_.system();
    info.pfnGetInstanceProcAddr = vkGetInstanceProcAddr;
    info.vulkanPhysicalDevice = physical;
    info.vulkanCreateInfo = &wanted;
    VkResult result = VK_SUCCESS;
    xr_.check(xr_.xr().xrCreateVulkanDeviceKHR(xr_.handle(), &info, made, &result), "xrCreateVulkanDeviceKHR");
    return result;
  }

 private:
  const Instance& xr_;
};

}  // namespace

void set_android_context(const AndroidContext& c) { context() = c; }

Instance::Instance() {
  load();
  create();
  try {
    find_system();
  } catch (...) {
    functions_.xrDestroyInstance(instance_);
    throw;
  }
}

Instance::~Instance() { functions_.xrDestroyInstance(instance_); }

PFN_xrVoidFunction Instance::address(const char* name) const {
  PFN_xrVoidFunction found = nullptr;
  if (XR_FAILED(get_(instance_, name, &found))) return nullptr;
  return found;
}

void Instance::load() {
  void* loader = nullptr;
  for (const char* name : {"libopenxr_loader.so.1", "libopenxr_loader.so"})
    if (loader == nullptr) loader = dlopen(name, RTLD_NOW | RTLD_LOCAL);
  if (loader == nullptr)
    throw Error("no OpenXR loader, libopenxr_loader.so.1 (Debian: libopenxr-loader1)", ExitCode::NoDevice);
  get_ = reinterpret_cast<PFN_xrGetInstanceProcAddr>(dlsym(loader, "xrGetInstanceProcAddr"));
  if (get_ == nullptr) throw Error("the OpenXR loader has no xrGetInstanceProcAddr", ExitCode::NoDevice);
  if (context().vm == nullptr) return;
  const AndroidInfo info{kTypeLoaderInitAndroid, nullptr, context().vm, context().activity};
  using InitializeLoader = XrResult(XRAPI_PTR*)(const void*);
  const auto initialize = function<InitializeLoader>("xrInitializeLoaderKHR");  // only on Android
  if (initialize != nullptr && XR_FAILED(initialize(&info)))
    throw Error("the OpenXR loader rejected the Android activity (xrInitializeLoaderKHR)", ExitCode::NoDevice);
}

void Instance::create() {
  const auto enumerate = function<PFN_xrEnumerateInstanceExtensionProperties>("xrEnumerateInstanceExtensionProperties");
  const auto create = function<PFN_xrCreateInstance>("xrCreateInstance");
  std::uint32_t count = 0;
  if (enumerate == nullptr || create == nullptr || XR_FAILED(enumerate(nullptr, 0, &count, nullptr)))
    throw Error("no OpenXR runtime is active; start one, or set XR_RUNTIME_JSON", ExitCode::NoDevice);
  std::vector<XrExtensionProperties> properties(count, blank<XrExtensionProperties>(XR_TYPE_EXTENSION_PROPERTIES));
  if (XR_FAILED(enumerate(nullptr, count, &count, properties.data())))
    throw Error("xrEnumerateInstanceExtensionProperties failed", ExitCode::NoDevice);
  std::set<std::string> there;
  for (const auto& p : properties) there.insert(p.extensionName);
  if (!there.contains(XR_KHR_VULKAN_ENABLE2_EXTENSION_NAME))
    throw Error("the OpenXR runtime does not support Vulkan (XR_KHR_vulkan_enable2)", ExitCode::NoDevice);
  enabled_ = {XR_KHR_VULKAN_ENABLE2_EXTENSION_NAME};
  for (const char* name : kWelcome)
    if (there.contains(name)) enabled_.insert(name);
  if (context().vm != nullptr) enabled_.insert(kAndroidCreate);
  std::vector<const char*> names;
  for (const std::string& name : enabled_) names.push_back(name.c_str());
  const AndroidInfo android{kTypeInstanceCreateAndroid, nullptr, context().vm, context().activity};
  auto info = blank<XrInstanceCreateInfo>(XR_TYPE_INSTANCE_CREATE_INFO);
  info.next = context().vm != nullptr ? &android : nullptr;
  std::strcpy(info.applicationInfo.applicationName, "clothbench");
  info.applicationInfo.apiVersion = XR_MAKE_VERSION(1, 0, 0);
  info.enabledExtensionCount = static_cast<std::uint32_t>(names.size());
  info.enabledExtensionNames = names.data();
  const XrResult result = create(&info, &instance_);
  if (XR_FAILED(result))
    throw Error(
        fmt::format("no OpenXR instance: xrCreateInstance gave {}; is the runtime running?", static_cast<int>(result)),
        ExitCode::NoDevice);
#define CLOTHBENCH_XR_LOAD(name)                 \
  functions_.name = function<PFN_##name>(#name); \
  if (functions_.name == nullptr) throw Error("the OpenXR runtime has no " #name, ExitCode::NoDevice);
  CLOTHBENCH_XR_FUNCTIONS(CLOTHBENCH_XR_LOAD)
#undef CLOTHBENCH_XR_LOAD
}

void Instance::find_system() {
  auto runtime = blank<XrInstanceProperties>(XR_TYPE_INSTANCE_PROPERTIES);
  check(functions_.xrGetInstanceProperties(instance_, &runtime), "xrGetInstanceProperties");
  const XrVersion v = runtime.runtimeVersion;
  runtime_name_ =
      fmt::format("{} {}.{}.{}", runtime.runtimeName, XR_VERSION_MAJOR(v), XR_VERSION_MINOR(v), XR_VERSION_PATCH(v));
  auto get = blank<XrSystemGetInfo>(XR_TYPE_SYSTEM_GET_INFO);
  get.formFactor = XR_FORM_FACTOR_HEAD_MOUNTED_DISPLAY;
  if (XR_FAILED(functions_.xrGetSystem(instance_, &get, &system_)))
    throw Error(runtime_name_ + ": no headset is connected (xrGetSystem)", ExitCode::NoDevice);
  auto hands = blank<XrSystemHandTrackingPropertiesEXT>(XR_TYPE_SYSTEM_HAND_TRACKING_PROPERTIES_EXT);
  auto properties = blank<XrSystemProperties>(XR_TYPE_SYSTEM_PROPERTIES);
  if (has(XR_EXT_HAND_TRACKING_EXTENSION_NAME)) properties.next = &hands;
  check(functions_.xrGetSystemProperties(instance_, system_, &properties), "xrGetSystemProperties");
  system_name_ = properties.systemName;
  tracks_hands_ = hands.supportsHandTracking == XR_TRUE;
  auto needs = blank<XrGraphicsRequirementsVulkan2KHR>(XR_TYPE_GRAPHICS_REQUIREMENTS_VULKAN2_KHR);
  check(functions_.xrGetVulkanGraphicsRequirements2KHR(instance_, system_, &needs),
        "xrGetVulkanGraphicsRequirements2KHR");
  if (needs.minApiVersionSupported > XR_MAKE_VERSION(1, 1, 0xffff))
    throw Error(
        fmt::format("{} needs at least Vulkan {}.{}; this program uses 1.1", runtime_name_,
                    XR_VERSION_MAJOR(needs.minApiVersionSupported), XR_VERSION_MINOR(needs.minApiVersionSupported)),
        ExitCode::NoDevice);
}

void Instance::check(XrResult result, const char* call) const {
  if (XR_SUCCEEDED(result)) return;
  char text[XR_MAX_RESULT_STRING_SIZE] = "";
  if (functions_.xrResultToString == nullptr || XR_FAILED(functions_.xrResultToString(instance_, result, text)))
    std::snprintf(text, sizeof text, "XrResult %d", static_cast<int>(result));
  throw Error(fmt::format("{} failed: {}", call, text), ExitCode::CheckFailed);
}

std::shared_ptr<vulkan::Device> Instance::make_device(const DeviceOptions& options) const {
  RuntimeMaker maker(*this);
  return vulkan::Device::make(options, maker);
}

}  // namespace clothbench::xr

#pragma once
#include <set>
#include <string>

#include "vulkan/device.hpp"
#include "xr/openxr.hpp"

namespace clothbench::xr {

// clang-format off
#define CLOTHBENCH_XR_FUNCTIONS(X)                                                                                     \
  X(xrDestroyInstance) X(xrGetInstanceProperties) X(xrPollEvent) X(xrResultToString) X(xrPathToString) X(xrGetSystem)  \
  X(xrGetSystemProperties) X(xrEnumerateEnvironmentBlendModes) X(xrCreateSession) X(xrDestroySession)                  \
  X(xrCreateReferenceSpace) X(xrDestroySpace)                                                                            \
  X(xrEnumerateViewConfigurationViews) X(xrEnumerateSwapchainFormats) X(xrCreateSwapchain) X(xrDestroySwapchain)       \
  X(xrEnumerateSwapchainImages) X(xrAcquireSwapchainImage) X(xrWaitSwapchainImage) X(xrReleaseSwapchainImage)          \
  X(xrBeginSession) X(xrEndSession) X(xrRequestExitSession) X(xrWaitFrame) X(xrBeginFrame) X(xrEndFrame)               \
  X(xrLocateViews) X(xrGetVulkanGraphicsRequirements2KHR) X(xrCreateVulkanInstanceKHR) X(xrGetVulkanGraphicsDevice2KHR)                 \
  X(xrCreateVulkanDeviceKHR)
// clang-format on

struct Functions {
#define CLOTHBENCH_XR_MEMBER(name) PFN_##name name = nullptr;
  CLOTHBENCH_XR_FUNCTIONS(CLOTHBENCH_XR_MEMBER)
#undef CLOTHBENCH_XR_MEMBER
};

/// Handles that OpenXR runtimes on Android require: Java VM and activity (a global reference). Null on other systems.
struct AndroidContext {
  void* vm = nullptr;
  void* activity = nullptr;
};
/// Sets the context of the process; the owner of the activity calls this before a session begins.
void set_android_context(const AndroidContext&);

/// An OpenXR runtime, its head-mounted system, and the available ones of the extensions that we use.
class Instance {
 public:
  /// Uses the runtime that the system's loader finds ($XR_RUNTIME_JSON etc.). Throws Error with ExitCode::NoDevice if
  /// there is no loader, no runtime, no headset, or no XR_KHR_vulkan_enable2.
  Instance();
  ~Instance();
  Instance(const Instance&) = delete;
  Instance& operator=(const Instance&) = delete;

  const Functions& xr() const { return functions_; }
  XrInstance handle() const { return instance_; }
  XrSystemId system() const { return system_; }
  const std::string& runtime_name() const { return runtime_name_; }  ///< name and version
  const std::string& system_name() const { return system_name_; }
  bool has(const std::string& extension) const { return enabled_.contains(extension); }
  bool tracks_hands() const { return tracks_hands_; }

  /// A function of an extension; null if the runtime lacks it.
  template <class Function>
  Function function(const std::string& name) const {
    return reinterpret_cast<Function>(address(name.c_str()));
  }
  /// Calls a function of an extension, which must take arguments of exactly these types.
  template <class... Arguments>
  XrResult call(const std::string& name, Arguments... arguments) const {
    const auto found = function<XrResult(XRAPI_PTR*)(Arguments...)>(name);
    return found != nullptr ? found(arguments...) : XR_ERROR_FUNCTION_UNSUPPORTED;
  }
  /// Throws Error with the call and the runtime's name for the result, unless the result is a success.
  void check(XrResult result, const char* call) const;

  /// The Vulkan device that drives this system's display; vulkan::Device::get with these options then returns it.
  std::shared_ptr<vulkan::Device> make_device(const DeviceOptions&) const;

 private:
  PFN_xrVoidFunction address(const char* name) const;
  void load();
  void create();
  void find_system();

  PFN_xrGetInstanceProcAddr get_ = nullptr;
  Functions functions_;
  XrInstance instance_ = XR_NULL_HANDLE;
  XrSystemId system_ = XR_NULL_SYSTEM_ID;
  std::set<std::string> enabled_;
  std::string runtime_name_, system_name_;
  bool tracks_hands_ = false;
};

}  // namespace clothbench::xr

#pragma once
// OpenXR without prototypes: every function is queried from the runtime, so that nothing links to a loader.
#include <vulkan/vulkan.h>
#define XR_NO_PROTOTYPES
#define XR_USE_GRAPHICS_API_VULKAN
#include <openxr/openxr.h>
#include <openxr/openxr_platform.h>

#include <cstddef>
#include <cstdint>

/// Declarations of the OpenXR 1.1 specification that the oldest supported headers (1.0.20) lack or restrict to Android.
/// Numbers and layouts are the specification's; names are ours, to avoid clashes with newer headers.
namespace clothbench::xr {

/// A structure of this type, all else 0.
template <class T>
T blank(XrStructureType type) {
  T t{};
  t.type = type;
  return t;
}

/// XR_KHR_loader_init_android and XR_KHR_android_create_instance: the same layout with different types.
inline constexpr auto kTypeLoaderInitAndroid = static_cast<XrStructureType>(1000089000);
inline constexpr auto kTypeInstanceCreateAndroid = static_cast<XrStructureType>(1000008000);
struct AndroidInfo {
  XrStructureType type;
  const void* next;
  void* vm;
  void* activity;  ///< for the loader: a Context; an activity is one
};

/// Entry into a runtime's library without a loader (chapter "Loader Design", runtime negotiation).
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
using NegotiateRuntime = XrResult(XRAPI_PTR*)(const NegotiateLoaderInfo*, NegotiateRuntimeRequest*);

}  // namespace clothbench::xr

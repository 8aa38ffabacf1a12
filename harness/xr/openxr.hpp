#pragma once
// OpenXR without prototypes: every function is queried from the runtime, so that no loader is linked.
#include <vulkan/vulkan.h>
#define XR_NO_PROTOTYPES
#define XR_USE_GRAPHICS_API_VULKAN
#include <openxr/openxr.h>
#include <openxr/openxr_platform.h>

/// Declarations of the OpenXR 1.1 specification that the oldest supported headers (1.0.20) lack or restrict to Android.
/// Numbers and layouts are the specification's; names are ours, so that they do not clash with newer headers.
namespace clothbench::xr {

/// A structure with its type set and all other members 0.
template <class T>
T blank(XrStructureType type) {
  T t{};
  t.type = type;
  return t;
}

/// XR_KHR_loader_init_android and XR_KHR_android_create_instance: equal layouts with different types.
inline constexpr auto kTypeLoaderInitAndroid = static_cast<XrStructureType>(1000089000);
inline constexpr auto kTypeInstanceCreateAndroid = static_cast<XrStructureType>(1000008000);
struct AndroidInfo {
  XrStructureType type;
  const void* next;
  void* vm;
  void* activity;  ///< for the loader: a Context; an activity is one
};

/// XR_ANDROID_performance_metrics and XR_META_performance_metrics: equal layouts, different suffixes and types.
struct Metrics {
  const char *extension, *suffix;
  XrStructureType state, counter;
};
inline constexpr Metrics kMetrics[] = {
    {"XR_ANDROID_performance_metrics", "ANDROID", XrStructureType(1000465000), XrStructureType(1000465001)},
    {"XR_META_performance_metrics", "META", XrStructureType(1000232001), XrStructureType(1000232002)}};
struct MetricsState {
  XrStructureType type;
  const void* next;
  XrBool32 enabled;
};
inline constexpr XrFlags64 kWholeValid = 2, kRealValid = 4;
struct MetricsCounter {
  XrStructureType type;
  const void* next;
  XrFlags64 flags;
  std::uint32_t unit, whole;
  float real;
};

}  // namespace clothbench::xr

#pragma once
// OpenXR without prototypes: every function is queried from the runtime, so that no loader is linked.
#include <vulkan/vulkan.h>

#include <array>
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

/// The layout of most structures of the extensions below, by the specification's number of the structure.
template <int kType>
struct Block {
  XrStructureType type = XrStructureType(kType);
  const void* next = nullptr;
  std::int32_t number = 0;     ///< count of the items, capability, result or state
  std::uint32_t count = 0;     ///< of the items beside a capability
  const void* data = nullptr;  ///< items, or the handle that was made
};

/// XR_ANDROID_performance_metrics and XR_META_performance_metrics: equal layouts, different suffixes and types.
struct Metrics {
  const char *extension, *suffix;
  XrStructureType state, counter;
};
inline constexpr Metrics kMetrics[] = {
    {"XR_ANDROID_performance_metrics", "ANDROID", XrStructureType(1000465000), XrStructureType(1000465001)},
    {"XR_META_performance_metrics", "META", XrStructureType(1000232001), XrStructureType(1000232002)}};
inline constexpr XrFlags64 kWholeValid = 2, kRealValid = 4;
struct MetricsCounter {
  XrStructureType type;
  const void* next;
  XrFlags64 flags;
  std::uint32_t unit, whole;
  float real;
};

/// XR_EXT_spatial_plane_tracking and the extensions that it requires. Handles and futures are pointers (64-bit
/// systems).
inline constexpr std::array kPlanes = {"XR_EXT_spatial_plane_tracking", "XR_EXT_spatial_entity", "XR_EXT_future"};
inline constexpr int kPlaneTracking = 1000741000, kBounds = 1, kAlignment = 1000741000, kLabel = 1000741003;
inline constexpr int kTracked = 3, kFacesUp = 0, kTable = 5;
inline constexpr auto kFuturePending = XrResult(-1000469001), kComponentUnsupported = XrResult(-1000740004);
struct SnapshotCompletionInfo {
  XrStructureType type = XrStructureType(1000740004);
  const void* next = nullptr;
  XrSpace base = XR_NULL_HANDLE;
  XrTime time = 0;
  const void* future = nullptr;
};
struct QueryResult {
  XrStructureType type = XrStructureType(1000740007);
  const void* next = nullptr;
  std::uint32_t id_capacity = 0, id_count = 0;
  std::uint64_t* ids = nullptr;
  std::uint32_t state_capacity = 0, state_count = 0;
  int* states = nullptr;
};
struct Bounds2D {  ///< in the x-y plane of its pose; z is the normal
  XrPosef center;
  XrExtent2Df extent_m;
};

}  // namespace clothbench::xr

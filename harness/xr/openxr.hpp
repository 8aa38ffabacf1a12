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

/// Whether a place is known whole; flags of a space's location.
inline bool is_known(XrSpaceLocationFlags flags) {
  constexpr XrSpaceLocationFlags kKnown =
      XR_SPACE_LOCATION_POSITION_VALID_BIT | XR_SPACE_LOCATION_ORIENTATION_VALID_BIT;
  return (flags & kKnown) == kKnown;
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

/// XR_FB_spatial_entity, XR_FB_spatial_entity_query, XR_META_spatial_entity_mesh.
inline constexpr const char* kSpatialEntity = "XR_FB_spatial_entity";
inline constexpr const char* kSpatialEntityQuery = "XR_FB_spatial_entity_query";
inline constexpr const char* kSpatialEntityMesh = "XR_META_spatial_entity_mesh";
inline constexpr auto kTypeComponentStatus = static_cast<XrStructureType>(1000113001);
inline constexpr auto kTypeComponentStatusSet = static_cast<XrStructureType>(1000113007);
inline constexpr auto kTypeComponentStatusSetComplete = static_cast<XrStructureType>(1000113006);
inline constexpr auto kTypeSpaceQuery = static_cast<XrStructureType>(1000156001);
inline constexpr auto kTypeSpaceQueryResults = static_cast<XrStructureType>(1000156002);
inline constexpr auto kTypeSpaceComponentFilter = static_cast<XrStructureType>(1000156052);
inline constexpr auto kTypeSpaceQueryAvailable = static_cast<XrStructureType>(1000156103);
inline constexpr auto kTypeSpaceQueryComplete = static_cast<XrStructureType>(1000156104);
inline constexpr auto kTypeTriangleMeshGetInfo = static_cast<XrStructureType>(1000269001);
inline constexpr auto kTypeTriangleMesh = static_cast<XrStructureType>(1000269002);
inline constexpr int kComponentLocatable = 0, kComponentTriangleMesh = 1000269000;
using RequestId = std::uint64_t;
struct Uuid {
  std::uint8_t data[16];
};
struct ComponentStatus {
  XrStructureType type;
  void* next;
  XrBool32 enabled, change_pending;
};
struct ComponentStatusSet {
  XrStructureType type;
  const void* next;
  int component;
  XrBool32 enabled;
  XrDuration timeout;
};
struct SpaceComponentFilter {
  XrStructureType type;
  const void* next;
  int component;
};
struct SpaceQuery {
  XrStructureType type;
  const void* next;
  int action;
  std::uint32_t max_results;
  XrDuration timeout;
  const void *filter, *exclude;
};
struct SpaceQueryResult {
  XrSpace space;
  Uuid uuid;
};
struct SpaceQueryResults {
  XrStructureType type;
  void* next;
  std::uint32_t capacity, count;
  SpaceQueryResult* results;
};
struct EventSpaceQueryAvailable {
  XrStructureType type;
  const void* next;
  RequestId request;
};
struct EventSpaceQueryComplete {
  XrStructureType type;
  const void* next;
  RequestId request;
  XrResult result;
};
struct TriangleMeshGetInfo {
  XrStructureType type;
  const void* next;
};
struct TriangleMeshOutput {
  XrStructureType type;
  void* next;
  std::uint32_t vertex_capacity, vertex_count;
  XrVector3f* vertices;
  std::uint32_t index_capacity, index_count;
  std::uint32_t* indices;
};
using QuerySpaces = XrResult(XRAPI_PTR*)(XrSession, const SpaceQuery*, RequestId*);
using RetrieveSpaceQueryResults = XrResult(XRAPI_PTR*)(XrSession, RequestId, SpaceQueryResults*);
using GetSpaceComponentStatus = XrResult(XRAPI_PTR*)(XrSpace, int component, ComponentStatus*);
using SetSpaceComponentStatus = XrResult(XRAPI_PTR*)(XrSpace, const ComponentStatusSet*, RequestId*);
using GetSpaceTriangleMesh = XrResult(XRAPI_PTR*)(XrSpace, const TriangleMeshGetInfo*, TriangleMeshOutput*);

/// XR_META_performance_metrics.
inline constexpr const char* kPerformanceMetrics = "XR_META_performance_metrics";
inline constexpr auto kTypeMetricsState = static_cast<XrStructureType>(1000232001);
inline constexpr auto kTypeMetricsCounter = static_cast<XrStructureType>(1000232002);
inline constexpr XrFlags64 kCounterUintValid = 2, kCounterFloatValid = 4;
struct MetricsState {
  XrStructureType type;
  const void* next;
  XrBool32 enabled;
};
struct MetricsCounter {
  XrStructureType type;
  const void* next;
  XrFlags64 flags;
  int unit;  ///< 0 number, 1 per cent, 2 ms, 3 B, 4 Hz
  std::uint32_t uint_value;
  float float_value;
};
using EnumerateMetricsCounterPaths = XrResult(XRAPI_PTR*)(XrInstance, std::uint32_t, std::uint32_t*, XrPath*);
using SetMetricsState = XrResult(XRAPI_PTR*)(XrSession, const MetricsState*);
using QueryMetricsCounter = XrResult(XRAPI_PTR*)(XrSession, XrPath, MetricsCounter*);

}  // namespace clothbench::xr

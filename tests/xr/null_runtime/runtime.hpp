#pragma once
#include <algorithm>
#include <array>
#include <deque>
#include <map>
#include <memory>
#include <set>
#include <string>
#include <vector>

#include "script.hpp"
#include "xr/openxr.hpp"

/// An OpenXR runtime without a headset: a clock that only frames advance, a script instead of a user, real Vulkan
/// images. Checks every call strictly. $CLOTHBENCH_NULL_XR is a list of `key=value`, separated by commas:
///   stalls=20:0.02;40:0.03   after 20 (40) frames the application counts as 0.02 s (0.03 s) late
///   multiple=200   from the sixth frame on, reports that multiple of the display's period, as after slow frames
///   hands|capsules|rate=0   omits an extension
///   ANDROID|META=1   offers performance counters, by XR_ANDROID_… or XR_META_performance_metrics
///   planes=1   offers planes, after some frames; planes=2: without the table; labels=0: without labels
///   unseen=10:20   hands are not tracked from the 10th frame up to the 20th
///   unmeasured=10:20   reading a counter fails in these frames
///   blind=1        requests no images, which take lavapipe most of the time
///   quit=30        the user takes off the headset at that frame
///   look=25        the images of that frame are read and checked
///   log=FILE       a JSON log, written when the instance ends
namespace null_xr {

struct Swapchain {
  VkExtent2D extent{};
  std::vector<VkImage> images;
  std::vector<VkDeviceMemory> memory;
  std::uint32_t next = 0, acquired = ~0u, released = ~0u;
  bool waited = false;
};

struct Runtime {
  Runtime();
  std::map<std::string, std::string> options;
  double number(const std::string& key, double otherwise) const;
  /// Whether this frame is in the span of frames that the option `key` has, such as 10:20.
  bool within(const std::string& key) const;

  std::vector<std::string> faults;
  XrResult fault(const std::string& what, XrResult result) {
    faults.push_back(what);
    return result;
  }

  // Session.
  std::deque<XrEventDataBuffer> events;
  XrSessionState state = XR_SESSION_STATE_UNKNOWN;
  bool session = false, running = false;
  void go(XrSessionState);
  VkPhysicalDevice physical = VK_NULL_HANDLE;
  VkDevice device = VK_NULL_HANDLE;
  VkQueue queue = VK_NULL_HANDLE;

  // Clock.
  double rate_hz = 90, next_rate_hz = 90;
  XrDuration period_ns() const { return static_cast<XrDuration>(1e9 / rate_hz + 0.5); }
  static constexpr XrTime kBegin_ns = 1'000'000'000;
  XrTime wake_ns = kBegin_ns;
  bool waited = false, begun = false;
  int frames = 0, ended = 0;
  double seconds(XrTime t) const { return static_cast<double>(t - kBegin_ns) * 1e-9; }

  // Requests.
  int projection_frames = 0;
  std::array<double, 2> drawn{-1, -1};
  bool android = false;
  std::set<std::string> enabled;  ///< extensions
  bool measures = false;
  int counter_calls = 0, plane_calls = 0, plane_handles = 0, planes_ready = 0;
  Pose base, space;  ///< of planes; the last space that was created

  std::map<std::uint64_t, Pose> spaces;  ///< in LOCAL
  std::map<std::uint64_t, std::unique_ptr<Swapchain>> swapchains;
  std::uint64_t handles = 1000;
  int trackers = 0;
};

Runtime* runtime();

template <class Handle>
Handle handle(std::uint64_t n) {
  return reinterpret_cast<Handle>(n);
}
template <class Handle>
std::uint64_t number_of(Handle h) {
  return reinterpret_cast<std::uint64_t>(h);
}

/// The items that a function of OpenXR enumerates.
template <class T>
XrResult list(const std::vector<T>& items, std::uint32_t capacity, std::uint32_t* count, T* out) {
  *count = static_cast<std::uint32_t>(items.size());
  if (capacity == 0) return XR_SUCCESS;
  if (capacity < *count) return XR_ERROR_SIZE_INSUFFICIENT;
  std::copy(items.begin(), items.end(), out);
  return XR_SUCCESS;
}

XrPosef as_xr(const Pose&);
Pose from_xr(const XrPosef&);

/// A function of this file by name; null if there is none.
#define NULL_XR(text, function) \
  if (name == text) return reinterpret_cast<PFN_xrVoidFunction>(function);
PFN_xrVoidFunction frame_function(const std::string& name);
PFN_xrVoidFunction graphics_function(const std::string& name);

/// Fraction of the pixels of the last released image that are neither white nor transparent.
double drawn_share(Runtime&, const Swapchain&);

}  // namespace null_xr

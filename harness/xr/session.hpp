#pragma once
#include <array>
#include <memory>
#include <optional>
#include <vector>

#include "assets/hand_track.hpp"
#include "clothbench/collider.hpp"
#include "clothbench/record.hpp"
#include "render/scene_renderer.hpp"
#include "xr/instance.hpp"

namespace clothbench::xr {

struct SessionOptions {
  double rate_hz = 72;  ///< requested refresh rate of the display, if the runtime allows it
  Vec3 origin_m{};      ///< the scene's origin in LOCAL space, whose origin is at the head
};

/// Images of one eye.
struct Eye {
  XrSwapchain swapchain = XR_NULL_HANDLE;
  std::vector<VkImage> images;
};

/// An OpenXR session: its states, clock and images. All positions are in the scene's space.
///
/// A frame is `wait_frame`, `begin_frame`, `end_frame`, while `running()`; call `pump` between frames.
class Session {
 public:
  Session(const Instance&, std::shared_ptr<vulkan::Device>, const SessionOptions&);
  ~Session();
  Session(const Session&) = delete;
  Session& operator=(const Session&) = delete;

  /// Processes the runtime's events; begins and ends the session as they require. False once the session is over.
  bool pump();
  bool running() const { return running_; }
  void request_exit();
  void create_space(const Vec3& origin_m);  ///< the scene's space, again if its origin changes
  XrFrameState wait_frame();
  void begin_frame();
  /// Shows the rendered images, or nothing if `views` is empty.
  void end_frame(const XrFrameState&, const std::vector<XrView>& views);
  /// Both eyes in the scene's space; empty if they are not tracked.
  std::vector<XrView> views(XrTime) const;

  const Instance& instance() const { return xr_; }
  XrSession handle() const { return session_; }
  XrSpace space() const { return space_; }
  VkFormat format() const { return format_; }
  VkExtent2D extent() const { return extent_; }
  const std::array<Eye, 2>& eyes() const { return eyes_; }

 private:
  void create_session();
  void create_eyes();
  void choose_blend_mode();
  void request_rate(double rate_hz) const;
  void change(XrSessionState);
  void release();

  const Instance& xr_;
  std::shared_ptr<vulkan::Device> device_;
  const double rate_hz_;
  XrSession session_ = XR_NULL_HANDLE;
  XrSpace space_ = XR_NULL_HANDLE;
  bool running_ = false, over_ = false;
  VkFormat format_ = VK_FORMAT_UNDEFINED;
  VkExtent2D extent_{};
  std::array<Eye, 2> eyes_;
  XrEnvironmentBlendMode blend_ = XR_ENVIRONMENT_BLEND_MODE_OPAQUE;
};

/// Hands tracked by the runtime (XR_EXT_hand_tracking), with its capsules if it provides them.
class Hands {
 public:
  explicit Hands(const Session&);
  ~Hands();
  Hands(const Hands&) = delete;
  Hands& operator=(const Hands&) = delete;

  /// The hand in the scene's space; empty unless every joint is known.
  std::optional<assets::RecordedHand> at(assets::Side, XrTime) const;
  bool has_capsules() const { return capsules_; }

 private:
  const Session& session_;
  bool capsules_ = false;
  PFN_xrLocateHandJointsEXT locate_ = nullptr;
  std::array<XrHandTrackerEXT, 2> trackers_{};
};

/// Performance counters of the runtime: XR_ANDROID_performance_metrics, otherwise XR_META_performance_metrics.
class Counters {
 public:
  explicit Counters(const Session&);  ///< switches them on; the session must run
  void read();                        ///< for the next frame; NaN if the call fails or the value is not valid
  /// Group "xr/counters" of a result file, one value per frame; no array if the runtime has no counters.
  const StoredGroup& group() const { return group_; }

 private:
  const Session& session_;
  const Metrics* kind_ = nullptr;
  XrResult(XRAPI_PTR* query_)(XrSession, XrPath, MetricsCounter*) = nullptr;
  std::vector<XrPath> paths_;  ///< empty if the runtime has no counters
  StoredGroup group_{"xr/counters", {}, {}};
};

/// Search for the user's table by XR_EXT_spatial_plane_tracking: of the planes that face up and are labelled as tables,
/// the one with the largest area / (1 m² + squared distance from `near_m`). If the runtime has no labels, planes 0.4 to
/// 1.3 m above the lowest one that faces up count as tables, or the only one.
class TableSearch {
 public:
  /// Throws Error with ExitCode::NoDevice if the runtime lacks an extension.
  TableSearch(const Session&, const Vec3& near_m);
  /// One step of the asynchronous search, once per frame. Null until a table is found, then a box as scene files have
  /// them, 4 cm thick, in the scene's space.
  nlohmann::json step(XrTime);

 private:
  nlohmann::json choose(const void* snapshot) const;

  const Session& session_;
  const Vec3 near_m_;
  const void *future_ = nullptr, *context_ = nullptr;
  std::vector<int> components_ = {kBounds, kAlignment, kLabel};
};

/// Renders both eyes into the session's images in one submission, without waiting; the next frame waits.
class Painter {
 public:
  Painter(std::shared_ptr<vulkan::Device>, Session&);
  ~Painter();
  Painter(const Painter&) = delete;
  Painter& operator=(const Painter&) = delete;

  /// The renderer. Call `wait` before replacing surfaces or positions.
  render::SceneRenderer& renderer() { return renderer_; }
  /// Waits until the images of the last submission are rendered. Throws vulkan::Failure.
  void wait();
  void paint(const std::vector<XrView>& views);
  double device_s() const { return device_s_; }  ///< of the images of the last `wait`; NaN without timestamps

 private:
  void record(const std::array<std::uint32_t, 2>& index, const std::vector<XrView>& views);

  std::shared_ptr<vulkan::Device> device_;
  Session& session_;
  render::SceneRenderer renderer_;
  VkCommandBuffer commands_ = VK_NULL_HANDLE;
  render::Owned<VkFence, vkDestroyFence> fence_;
  render::Owned<VkQueryPool, vkDestroyQueryPool> queries_;
  bool in_flight_ = false;
  double device_s_;
};

/// View matrix of an eye, for positions in metres relative to `origin_m`; and the projection of its field of view into
/// Vulkan's clip space (y down, depth 0 at near_m to 1 at far_m).
render::Mat4 view_of(const XrPosef&, const Vec3& origin_m);
render::Mat4 projection_of(const XrFovf&, double near_m, double far_m);

}  // namespace clothbench::xr

#pragma once
#include <array>
#include <memory>
#include <vector>

#include "clothbench/collider.hpp"
#include "xr/instance.hpp"

namespace clothbench::xr {

struct SessionOptions {
  double rate_hz = 72;  ///< requested refresh rate of the display, if the runtime allows it
  Vec3 origin_m{};      ///< the scene's origin in LOCAL space, which begins at the head
};

/// Images of one eye.
struct Eye {
  XrSwapchain swapchain = XR_NULL_HANDLE;
  std::vector<VkImage> images;
};

/// A session: its states, its clock and its pictures. All locations are in the scene's space.
///
/// A frame is `wait_frame`, `begin_frame`, `end_frame`, while `running()`; call `pump` between frames.
class Session {
 public:
  Session(const Instance&, std::shared_ptr<vulkan::Device>, const SessionOptions&);
  ~Session();
  Session(const Session&) = delete;
  Session& operator=(const Session&) = delete;

  /// Processes the runtime's events, and begins and ends the session as they require. False once the session is over.
  bool pump();
  bool running() const { return running_; }
  void request_exit();
  XrFrameState wait_frame();
  void begin_frame();
  /// Shows the pictures drawn, or nothing if `views` is empty.
  void end_frame(const XrFrameState&, const std::vector<XrView>& views);
  /// Both eyes in the scene's space; empty if they are not located.
  std::vector<XrView> views(XrTime) const;

  const Instance& instance() const { return xr_; }
  XrSession handle() const { return session_; }
  XrSpace space() const { return space_; }
  VkFormat format() const { return format_; }
  VkExtent2D extent() const { return extent_; }
  const std::array<Eye, 2>& eyes() const { return eyes_; }

 private:
  void create_session();
  void create_space(const Vec3& origin_m);
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

}  // namespace clothbench::xr

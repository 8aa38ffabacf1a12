#pragma once
#include <memory>
#include <vector>

#include "render/scene_renderer.hpp"
#include "xr/session.hpp"

namespace clothbench::xr {

/// Draws both eyes into the session's images in one submission and does not wait for it; the next frame does.
class Painter {
 public:
  Painter(std::shared_ptr<vulkan::Device>, Session&);
  ~Painter();
  Painter(const Painter&) = delete;
  Painter& operator=(const Painter&) = delete;

  /// The renderer. Surfaces and positions may be replaced only after `wait`.
  render::SceneRenderer& renderer() { return renderer_; }
  /// Waits until the pictures submitted last are drawn. Throws vulkan::Failure.
  void wait();
  void paint(const std::vector<XrView>& views);
  double device_s() const { return device_s_; }  ///< of the pictures drawn at the last `wait`; NaN without timestamps

 private:
  void record(std::uint32_t left, std::uint32_t right, const std::vector<XrView>& views);
  void release();

  std::shared_ptr<vulkan::Device> device_;
  Session& session_;
  render::SceneRenderer renderer_;
  VkCommandBuffer commands_ = VK_NULL_HANDLE;
  VkFence fence_ = VK_NULL_HANDLE;
  VkQueryPool queries_ = VK_NULL_HANDLE;
  bool in_flight_ = false;
  double device_s_;
};

/// View matrix of an eye, in metres relative to `origin_m`; and projection matrix of its field of view to Vulkan's clip
/// space (y down, depth 0 at near_m to 1 at far_m).
render::Mat4 view_of(const XrPosef&, const Vec3& origin_m);
render::Mat4 projection_of(const XrFovf&, double near_m, double far_m);

}  // namespace clothbench::xr

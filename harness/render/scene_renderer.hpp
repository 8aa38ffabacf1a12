#pragma once
#include <vulkan/vulkan.h>

#include <memory>
#include <span>

#include "render/camera.hpp"
#include "render/pipelines.hpp"
#include "render/render_shared.h"
#include "vulkan/kernel.hpp"

namespace clothbench::render {

/// One view to render: the target image and the camera. The image has the renderer's colour format, one sample per
/// pixel and the usage COLOR_ATTACHMENT. Its content is overwritten, and afterwards its layout is
/// COLOR_ATTACHMENT_OPTIMAL, as OpenXR requires for swapchain images.
struct Drawing {
  VkImage image = VK_NULL_HANDLE;
  VkExtent2D extent{};
  Mat4 view{},
      projection{};  ///< view: from metres relative to SceneRenderer::origin(); projection: to Vulkan's clip space
};

/// Draws one cloth and its colliders with multisampling. It has no window and no frame loop: the caller owns the
/// images (a file's, a headset's eyes) and passes a command buffer for the queue of the renderer's device.
///
/// Its memory depends only on the scene. set_cloth, set_surfaces and a new image size replace objects that recorded
/// commands use, so no such command may be in flight then; write_positions overwrites the positions in place.
class SceneRenderer {
 public:
  static constexpr int kSamples = 4;  ///< supported by every graphics device (Vulkan 1.1, framebufferColorSampleCounts)

  /// Throws Error with ExitCode::NoDevice if the device's queue does not support graphics.
  SceneRenderer(std::shared_ptr<vulkan::Device> device, VkFormat colour);
  SceneRenderer(const SceneRenderer&) = delete;
  SceneRenderer& operator=(const SceneRenderer&) = delete;

  /// Sets the grid or the mesh, and the origin of all float32 coordinates: a point of the world near the scene.
  void set_cloth(const Cloth& cloth, const Vec3& origin_m);
  const Vec3& origin() const { return origin_m_; }

  /// Draws positions from a buffer of the same device: one vec4 per vertex, in order, relative to `buffer_origin_m`.
  /// The buffer must outlive its use here; images show its content at the time of drawing.
  void use_positions(const vulkan::Buffer& buffer, const Vec3& buffer_origin_m);
  /// Draws these positions, xyz interleaved [m], one per vertex (otherwise Error). NaN is allowed; triangles with NaN
  /// are not drawn.
  void write_positions(std::span<const double> position_m);

  void set_surfaces(const Surfaces&);

  /// Records the views in order, after a barrier for data that earlier commands on the queue write.
  void record(VkCommandBuffer, std::span<const Drawing>);
  /// Call before destroying an image that was a target.
  void forget(VkImage image);

 private:
  std::unique_ptr<vulkan::Buffer> filled(const char* name, const void* data, std::size_t bytes) const;
  void record_one(VkCommandBuffer, const Drawing&);
  Drawn constants(const Drawing&) const;

  std::shared_ptr<vulkan::Device> device_;
  VkFormat format_;
  Pipelines pipelines_;
  std::unique_ptr<Targets> targets_;  ///< for the last image's size
  std::size_t vertices_of_cloth_ = 0, triangles_of_cloth_ = 0;
  Vec3 origin_m_{}, buffer_origin_m_{};
  bool bound_ = false;
  std::unique_ptr<vulkan::Buffer> own_positions_, vertices_, corners_, mesh_;
  const vulkan::Buffer* positions_ = nullptr;
  std::uint32_t corner_count_ = 0;
};

}  // namespace clothbench::render

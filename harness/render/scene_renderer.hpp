#pragma once
#include <vulkan/vulkan.h>

#include <memory>
#include <span>

#include "render/camera.hpp"
#include "render/pipelines.hpp"
#include "render/render_shared.h"
#include "vulkan/kernel.hpp"

namespace clothbench::render {

/// One picture to draw: the target image and the camera. The image has the renderer's colour format, one sample a pixel
/// and the usage COLOR_ATTACHMENT. Its content is overwritten, and its layout is COLOR_ATTACHMENT_OPTIMAL afterwards,
/// as OpenXR requires for images of a swapchain.
struct Drawing {
  VkImage image = VK_NULL_HANDLE;
  VkExtent2D extent{};
  Mat4 view{},
      projection{};  ///< view: from metres relative to SceneRenderer::origin(); projection: to Vulkan's clip space
};

/// Draws one cloth and its colliders with multisampling. It has no window and no frame loop: the owner of the images (a
/// picture file, an eye of a headset) passes a command buffer to record into, for the queue of the same device.
///
/// Its memory grows with the scene only. set_cloth, set_surfaces and a picture of a new size replace
/// objects that commands recorded earlier use, so none of these commands may be in flight then; write_positions
/// overwrites the positions in place.
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

  /// Draws positions from a buffer of the same device: a vec4 for each vertex, in order, relative to `buffer_origin_m`.
  /// The buffer must outlive its use here; each picture shows its content at that time.
  void use_positions(const vulkan::Buffer& buffer, const Vec3& buffer_origin_m);
  /// Draws these positions, xyz interleaved [m], one per vertex (otherwise Error). Any may be NaN: its triangles are
  /// left out.
  void write_positions(std::span<const double> position_m);

  void set_surfaces(const Surfaces&);

  /// Records the pictures in order, after a barrier for data that earlier commands on the queue write.
  void record(VkCommandBuffer, std::span<const Drawing>);
  /// To be called before an image that was drawn into is destroyed.
  void forget(VkImage image);

 private:
  std::unique_ptr<vulkan::Buffer> filled(const char* name, const void* data, std::size_t bytes) const;
  void record_one(VkCommandBuffer, const Drawing&);
  Drawn constants(const Drawing&) const;

  std::shared_ptr<vulkan::Device> device_;
  VkFormat format_;
  Pipelines pipelines_;
  std::unique_ptr<Targets> targets_;  ///< of the last picture's size
  std::size_t vertices_of_cloth_ = 0, triangles_of_cloth_ = 0;
  Vec3 origin_m_{}, buffer_origin_m_{};
  bool bound_ = false;
  std::unique_ptr<vulkan::Buffer> own_positions_, vertices_, corners_, mesh_;
  const vulkan::Buffer* positions_ = nullptr;
  std::uint32_t corner_count_ = 0;
};

}  // namespace clothbench::render

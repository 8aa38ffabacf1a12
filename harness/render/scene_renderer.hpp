#pragma once
#include <vulkan/vulkan.h>

#include <memory>
#include <span>
#include <vector>

#include "render/camera.hpp"
#include "render/pipelines.hpp"
#include "render/render_shared.h"
#include "render/surfaces.hpp"
#include "render/targets.hpp"
#include "vulkan/buffer.hpp"

namespace clothbench::render {

/// One picture to draw: into which image, seen how. The image has the renderer's colour format, one sample a pixel and
/// the usage COLOR_ATTACHMENT; what it held is lost, and it is in the layout COLOR_ATTACHMENT_OPTIMAL afterwards, as an
/// OpenXR swapchain's image has to be.
struct Drawing {
  VkImage image = VK_NULL_HANDLE;
  std::uint32_t layer = 0;
  VkExtent2D extent{};
  Mat4 view{},
      projection{};  ///< view: from metres relative to SceneRenderer::origin(); projection: to Vulkan's clip space
};

/// Draws one cloth and what it touches, with several samples a pixel. It knows no window and no frame loop: whoever
/// owns images (a file to write, an eye of a headset) has it record into a command buffer of theirs, on the queue of
/// the same device.
///
/// All its memory is that of the scene it was given. What commands recorded earlier use is replaced by set_cloth,
/// write_values and set_surfaces, and by a picture of a new size, so nothing of its may be in flight then;
/// write_positions overwrites.
class SceneRenderer {
 public:
  static constexpr int kSamples = 4;  ///< every device that draws has them (Vulkan 1.1, framebufferColorSampleCounts)

  /// Throws Error with ExitCode::NoDevice where the device's queue cannot draw.
  SceneRenderer(std::shared_ptr<vulkan::Device> device, VkFormat colour);
  ~SceneRenderer();
  SceneRenderer(const SceneRenderer&) = delete;
  SceneRenderer& operator=(const SceneRenderer&) = delete;

  /// The grid, and the point of the world from which all is reckoned in float32: near the scene.
  void set_cloth(const Cloth& cloth, const Vec3& origin_m);
  const Vec3& origin() const { return origin_m_; }

  /// Positions come from a buffer of the same device, a vec4 a vertex, first vertex first, relative to
  /// `buffer_origin_m`. It outlives its use here; each picture shows what it holds then.
  void use_positions(const vulkan::Buffer& buffer, const Vec3& buffer_origin_m);
  /// Positions come from here, xyz interleaved [m], one for each vertex (else Error). Any may be NaN: triangles there
  /// are left out.
  void write_positions(std::span<const double> position_m);
  /// The picture goes with a vertex that began at `start_m`.
  void follow(std::uint32_t vertex, const Vec3& start_m);

  /// Colours the cloth by a number a vertex, 0 to 1 along `colours` (linear RGB, at least 2), NaN grey; without any by
  /// checkers.
  void write_values(std::span<const float> values, std::span<const vec4> colours);
  void set_surfaces(const Surfaces&);
  /// What is seen where nothing is, linear RGBA; white if never called. Alpha 0 lets a headset's cameras through.
  void set_background(const vec4& rgba) { background_ = rgba; }

  /// Records the pictures one after another: what each reads of earlier commands on the queue is waited for.
  void record(VkCommandBuffer, std::span<const Drawing>);
  /// Before an image that was drawn into is destroyed.
  void forget(VkImage image);

 private:
  std::unique_ptr<vulkan::Buffer> filled(const char* name, const void* data, std::size_t bytes) const;
  void bind_buffers();
  void record_one(VkCommandBuffer, const Drawing&);
  Drawn constants(const Drawing&) const;

  std::shared_ptr<vulkan::Device> device_;
  VkFormat format_;
  Pipelines pipelines_;
  std::unique_ptr<Targets> targets_;  ///< of the last picture's size
  int columns_ = 0, rows_ = 0;
  float squares_u_ = 0, squares_v_ = 0;
  Vec3 origin_m_{}, buffer_origin_m_{}, follow_start_m_{};
  int follow_vertex_ = -1;
  vec4 background_{1, 1, 1, 1};
  bool by_value_ = false, bound_ = false;
  std::unique_ptr<vulkan::Buffer> own_positions_, values_, colours_, vertices_, corners_;
  const vulkan::Buffer* positions_ = nullptr;
  std::uint32_t corner_count_ = 0;
};

}  // namespace clothbench::render

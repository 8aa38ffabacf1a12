#pragma once
#include <cstdint>
#include <memory>
#include <vector>

#include "render/scene_renderer.hpp"
#include "runner/solver_run.hpp"

namespace clothbench::render {

/// 8 bits per channel, sRGB, rgb interleaved, top row first.
struct Picture {
  int width = 0, height = 0;
  std::vector<std::uint8_t> rgb;

  Picture(int w, int h) : width(w), height(h), rgb(static_cast<std::size_t>(w) * static_cast<std::size_t>(h) * 3) {}
  const std::uint8_t* at(int x, int y) const {
    return &rgb[(static_cast<std::size_t>(y) * static_cast<std::size_t>(width) + static_cast<std::size_t>(x)) * 3];
  }
};

/// Images for offscreen rendering: one per view (eye), all of equal size.
class Offscreen {
 public:
  static constexpr VkFormat kFormat = VK_FORMAT_R8G8B8A8_SRGB;  ///< mandatory for colour targets (Vulkan 1.1, table 62)

  /// Throws Error if the device does not support images of this size.
  Offscreen(std::shared_ptr<vulkan::Device> device, VkExtent2D extent, std::size_t count);
  ~Offscreen();
  Offscreen(const Offscreen&) = delete;
  Offscreen& operator=(const Offscreen&) = delete;

  /// Renders each image with its own camera; complete on return. The renderer must outlive this object. Throws
  /// vulkan::Failure.
  void draw(SceneRenderer&, std::span<const Camera> cameras);
  /// Reads back image `k`.
  Picture read(std::size_t k);

 private:
  template <class Record>
  void submit(Record&&);

  std::shared_ptr<vulkan::Device> device_;
  VkExtent2D extent_;
  std::vector<std::unique_ptr<Image>> images_;
  std::unique_ptr<vulkan::Buffer> pixels_;
  VkCommandBuffer commands_ = VK_NULL_HANDLE;
  Owned<VkFence, vkDestroyFence> fence_;
  SceneRenderer* drawn_by_ = nullptr;
};

/// Renders both eyes of a headset, `width` x `height` pixels each, one after the other in one submission. For a GPU
/// solver the vertex shader reads the solver's buffer; for a CPU solver the positions of read_state are uploaded. The
/// measured time includes that upload and the rendering, but no wait for a display, because nothing is displayed.
Rendering stereo_rendering(int width, int height);

}  // namespace clothbench::render

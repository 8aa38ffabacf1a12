#pragma once
#include <vulkan/vulkan.h>

#include <array>
#include <map>
#include <memory>

#include "vulkan/buffer.hpp"

namespace clothbench::render {

/// The render pass (multisampled colour and depth, resolved to one sample) and its two pipelines, for cloth and for
/// colliders, which share a set of buffers.
class Pipelines {
 public:
  static constexpr std::uint32_t kBindings = 4;  ///< as in the shaders
  static constexpr VkFormat kDepthFormat = VK_FORMAT_D32_SFLOAT;

  Pipelines(std::shared_ptr<vulkan::Device> device, VkFormat colour, VkSampleCountFlagBits samples);
  ~Pipelines();
  Pipelines(const Pipelines&) = delete;
  Pipelines& operator=(const Pipelines&) = delete;

  VkRenderPass pass() const { return pass_; }
  /// Binds buffers[k] to binding k. No command recorded earlier may be in flight.
  void bind(const std::array<const vulkan::Buffer*, kBindings>& buffers);
  void use(VkCommandBuffer, bool cloth, const void* constants, std::uint32_t bytes) const;

 private:
  void create_pass(VkFormat colour, VkSampleCountFlagBits samples);
  void create_set();
  void create_layout();
  VkPipeline create(bool cloth, VkSampleCountFlagBits samples) const;
  void release();

  std::shared_ptr<vulkan::Device> device_;
  VkRenderPass pass_ = VK_NULL_HANDLE;
  VkDescriptorSetLayout set_layout_ = VK_NULL_HANDLE;
  VkPipelineLayout layout_ = VK_NULL_HANDLE;
  VkDescriptorPool pool_ = VK_NULL_HANDLE;
  VkDescriptorSet set_ = VK_NULL_HANDLE;
  VkPipeline cloth_ = VK_NULL_HANDLE, collider_ = VK_NULL_HANDLE;
};

/// An image with its memory and view.
class Image {
 public:
  Image(std::shared_ptr<vulkan::Device> device, VkFormat format, VkExtent2D extent, VkSampleCountFlagBits samples,
        VkImageUsageFlags usage);
  ~Image();
  Image(const Image&) = delete;
  Image& operator=(const Image&) = delete;
  VkImage handle() const { return image_; }
  VkImageView view() const { return view_; }

 private:
  void create(VkFormat format, VkExtent2D extent, VkSampleCountFlagBits samples, VkImageUsageFlags usage);
  void release();

  std::shared_ptr<vulkan::Device> device_;
  VkImage image_ = VK_NULL_HANDLE;
  VkDeviceMemory memory_ = VK_NULL_HANDLE;
  VkImageView view_ = VK_NULL_HANDLE;
};

/// A view of a colour image, or of its depth.
VkImageView make_view(VkDevice, VkImage, VkFormat);

/// Render targets for pictures of one size: multisampled colour and depth, and a framebuffer for each target image.
class Targets {
 public:
  Targets(std::shared_ptr<vulkan::Device> device, VkRenderPass pass, VkFormat colour, VkSampleCountFlagBits samples,
          VkExtent2D extent);
  ~Targets();
  Targets(const Targets&) = delete;
  Targets& operator=(const Targets&) = delete;
  VkExtent2D extent() const { return extent_; }
  VkFramebuffer framebuffer(VkImage image);
  void forget(VkImage image);

 private:
  struct Held {
    VkImageView view = VK_NULL_HANDLE;
    VkFramebuffer framebuffer = VK_NULL_HANDLE;
  };
  void release(const Held&) const;

  std::shared_ptr<vulkan::Device> device_;
  VkRenderPass pass_;
  VkFormat format_;
  VkExtent2D extent_;
  Image colour_, depth_;
  std::map<VkImage, Held> held_;
};

}  // namespace clothbench::render

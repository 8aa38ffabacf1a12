#pragma once
#include <vulkan/vulkan.h>

#include <array>
#include <map>
#include <memory>

#include "vulkan/kernel.hpp"

namespace clothbench::render {

/// A structure with its type set and all other members 0.
template <class T>
T blank(VkStructureType type) {
  T t{};
  t.sType = type;
  return t;
}

/// Owns an object of a device; the device must outlive it.
template <class Handle, void(VKAPI_PTR* kDestroy)(VkDevice, Handle, const VkAllocationCallbacks*)>
class Owned {
 public:
  Owned() = default;
  Owned(const Owned&) = delete;
  Owned& operator=(const Owned&) = delete;
  ~Owned() {
    if (handle_ != VK_NULL_HANDLE) kDestroy(device_, handle_, nullptr);
  }
  /// Address at which to create the object, once.
  Handle* create(VkDevice device) {
    device_ = device;
    return &handle_;
  }
  operator Handle() const { return handle_; }  // NOLINT: this is what the C API takes

 private:
  VkDevice device_ = VK_NULL_HANDLE;
  Handle handle_ = VK_NULL_HANDLE;
};

/// The render pass (multisampled colour and depth, resolved to one sample) and its two pipelines, for cloth and for
/// colliders, which use the same buffers.
class Pipelines {
 public:
  static constexpr std::uint32_t kBindings = 4;  ///< number of bindings in the shaders
  static constexpr VkFormat kDepthFormat = VK_FORMAT_D32_SFLOAT;

  Pipelines(std::shared_ptr<vulkan::Device> device, VkFormat colour, VkSampleCountFlagBits samples);

  VkRenderPass pass() const { return pass_; }
  /// Binds buffers[k] to binding k. Commands recorded before must have finished.
  void bind(const std::array<const vulkan::Buffer*, kBindings>& buffers);
  void use(VkCommandBuffer, bool cloth, const void* constants, std::uint32_t bytes) const;

 private:
  void create_pass(VkFormat colour, VkSampleCountFlagBits samples);
  using Pipeline = Owned<VkPipeline, vkDestroyPipeline>;
  void create(bool cloth, VkSampleCountFlagBits samples, Pipeline& to) const;

  std::shared_ptr<vulkan::Device> device_;
  Owned<VkRenderPass, vkDestroyRenderPass> pass_;
  Owned<VkDescriptorSetLayout, vkDestroyDescriptorSetLayout> set_layout_;
  Owned<VkPipelineLayout, vkDestroyPipelineLayout> layout_;
  Owned<VkDescriptorPool, vkDestroyDescriptorPool> pool_;
  VkDescriptorSet set_ = VK_NULL_HANDLE;
  Pipeline cloth_, collider_;
};

/// An image with its memory and view.
class Image {
 public:
  Image(std::shared_ptr<vulkan::Device> device, VkFormat format, VkExtent2D extent, VkSampleCountFlagBits samples,
        VkImageUsageFlags usage);
  VkImage handle() const { return image_; }
  VkImageView view() const { return view_; }

 private:
  std::shared_ptr<vulkan::Device> device_;
  Owned<VkImage, vkDestroyImage> image_;
  Owned<VkDeviceMemory, vkFreeMemory> memory_;
  Owned<VkImageView, vkDestroyImageView> view_;
};

/// Render targets for images of one size: multisampled colour and depth, and a framebuffer per target image.
class Targets {
 public:
  Targets(std::shared_ptr<vulkan::Device> device, VkRenderPass pass, VkFormat colour, VkSampleCountFlagBits samples,
          VkExtent2D extent);
  VkExtent2D extent() const { return extent_; }
  VkFramebuffer framebuffer(VkImage image);
  void forget(VkImage image) { held_.erase(image); }

 private:
  struct Held {
    Owned<VkImageView, vkDestroyImageView> view;
    Owned<VkFramebuffer, vkDestroyFramebuffer> framebuffer;
  };

  std::shared_ptr<vulkan::Device> device_;
  VkRenderPass pass_;
  VkFormat format_;
  VkExtent2D extent_;
  Image colour_, depth_;
  std::map<VkImage, Held> held_;
};

}  // namespace clothbench::render

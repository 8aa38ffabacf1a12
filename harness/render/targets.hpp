#pragma once
#include <vulkan/vulkan.h>

#include <map>
#include <memory>
#include <tuple>

#include "vulkan/device.hpp"

namespace clothbench::render {

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

/// A view of one layer of a colour image, or of its depth.
VkImageView make_view(VkDevice, VkImage, VkFormat, std::uint32_t layer);

/// Render targets for pictures of one size: multisampled colour and depth, and a framebuffer for each target image.
class Targets {
 public:
  Targets(std::shared_ptr<vulkan::Device> device, VkRenderPass pass, VkFormat colour, VkSampleCountFlagBits samples,
          VkExtent2D extent);
  ~Targets();
  Targets(const Targets&) = delete;
  Targets& operator=(const Targets&) = delete;
  VkExtent2D extent() const { return extent_; }
  VkFramebuffer framebuffer(VkImage image, std::uint32_t layer);
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
  std::map<std::tuple<VkImage, std::uint32_t>, Held> held_;
};

}  // namespace clothbench::render

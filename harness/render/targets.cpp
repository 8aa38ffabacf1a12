#include "render/targets.hpp"

#include <array>

#include "render/pipelines.hpp"

namespace clothbench::render {
namespace {

using vulkan::check;

}  // namespace

VkImageView make_view(VkDevice device, VkImage image, VkFormat format, std::uint32_t layer) {
  VkImageViewCreateInfo info{};
  info.sType = VK_STRUCTURE_TYPE_IMAGE_VIEW_CREATE_INFO;
  info.image = image;
  info.viewType = VK_IMAGE_VIEW_TYPE_2D;
  info.format = format;
  const bool depth = format == Pipelines::kDepthFormat;
  info.subresourceRange = {
      static_cast<VkImageAspectFlags>(depth ? VK_IMAGE_ASPECT_DEPTH_BIT : VK_IMAGE_ASPECT_COLOR_BIT), 0, 1, layer, 1};
  VkImageView view = VK_NULL_HANDLE;
  check(vkCreateImageView(device, &info, nullptr, &view), "vkCreateImageView");
  return view;
}

Image::Image(std::shared_ptr<vulkan::Device> device, VkFormat format, VkExtent2D extent, VkSampleCountFlagBits samples,
             VkImageUsageFlags usage)
    : device_(std::move(device)) {
  try {
    create(format, extent, samples, usage);
  } catch (...) {  // no destructor runs then
    release();
    throw;
  }
}

void Image::create(VkFormat format, VkExtent2D extent, VkSampleCountFlagBits samples, VkImageUsageFlags usage) {
  VkImageCreateInfo info{};
  info.sType = VK_STRUCTURE_TYPE_IMAGE_CREATE_INFO;
  info.imageType = VK_IMAGE_TYPE_2D;
  info.format = format;
  info.extent = {extent.width, extent.height, 1};
  info.mipLevels = info.arrayLayers = 1;
  info.samples = samples;
  info.tiling = VK_IMAGE_TILING_OPTIMAL;
  info.usage = usage;
  check(vkCreateImage(device_->handle(), &info, nullptr, &image_), "vkCreateImage");
  VkMemoryRequirements needs{};
  vkGetImageMemoryRequirements(device_->handle(), image_, &needs);
  VkMemoryAllocateInfo memory{};
  memory.sType = VK_STRUCTURE_TYPE_MEMORY_ALLOCATE_INFO;
  memory.allocationSize = needs.size;
  memory.memoryTypeIndex = vulkan::Device::kNoMemory;
  // A tiled GPU need not back at all what never leaves the chip.
  if ((usage & VK_IMAGE_USAGE_TRANSIENT_ATTACHMENT_BIT) != 0)
    memory.memoryTypeIndex = device_->memory_type(needs.memoryTypeBits, VK_MEMORY_PROPERTY_LAZILY_ALLOCATED_BIT);
  if (memory.memoryTypeIndex == vulkan::Device::kNoMemory)
    memory.memoryTypeIndex = device_->memory_type(needs.memoryTypeBits, VK_MEMORY_PROPERTY_DEVICE_LOCAL_BIT);
  if (memory.memoryTypeIndex == vulkan::Device::kNoMemory)
    memory.memoryTypeIndex = device_->memory_type(needs.memoryTypeBits, 0);
  check(vkAllocateMemory(device_->handle(), &memory, nullptr, &memory_), "vkAllocateMemory");
  check(vkBindImageMemory(device_->handle(), image_, memory_, 0), "vkBindImageMemory");
  view_ = make_view(device_->handle(), image_, format, 0);
}

Image::~Image() { release(); }

void Image::release() {
  vkDestroyImageView(device_->handle(), view_, nullptr);
  vkDestroyImage(device_->handle(), image_, nullptr);
  vkFreeMemory(device_->handle(), memory_, nullptr);
}

Targets::Targets(std::shared_ptr<vulkan::Device> device, VkRenderPass pass, VkFormat colour,
                 VkSampleCountFlagBits samples, VkExtent2D extent)
    : device_(device),
      pass_(pass),
      format_(colour),
      extent_(extent),
      colour_(device, colour, extent, samples,
              VK_IMAGE_USAGE_COLOR_ATTACHMENT_BIT | VK_IMAGE_USAGE_TRANSIENT_ATTACHMENT_BIT),
      depth_(device, Pipelines::kDepthFormat, extent, samples,
             VK_IMAGE_USAGE_DEPTH_STENCIL_ATTACHMENT_BIT | VK_IMAGE_USAGE_TRANSIENT_ATTACHMENT_BIT) {}

Targets::~Targets() {
  for (const auto& [key, held] : held_) release(held);
}

void Targets::release(const Held& h) const {
  vkDestroyFramebuffer(device_->handle(), h.framebuffer, nullptr);
  vkDestroyImageView(device_->handle(), h.view, nullptr);
}

void Targets::forget(VkImage image) {
  for (auto it = held_.begin(); it != held_.end();)
    if (std::get<0>(it->first) == image) {
      release(it->second);
      it = held_.erase(it);
    } else {
      ++it;
    }
}

VkFramebuffer Targets::framebuffer(VkImage image, std::uint32_t layer) {
  Held& h = held_[{image, layer}];
  if (h.framebuffer != VK_NULL_HANDLE) return h.framebuffer;
  if (h.view == VK_NULL_HANDLE) h.view = make_view(device_->handle(), image, format_, layer);
  const std::array views = {colour_.view(), depth_.view(), h.view};
  VkFramebufferCreateInfo info{};
  info.sType = VK_STRUCTURE_TYPE_FRAMEBUFFER_CREATE_INFO;
  info.renderPass = pass_;
  info.attachmentCount = static_cast<std::uint32_t>(views.size());
  info.pAttachments = views.data();
  info.width = extent_.width;
  info.height = extent_.height;
  info.layers = 1;
  check(vkCreateFramebuffer(device_->handle(), &info, nullptr, &h.framebuffer), "vkCreateFramebuffer");
  return h.framebuffer;
}

}  // namespace clothbench::render

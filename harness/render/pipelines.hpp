#pragma once
#include <vulkan/vulkan.h>

#include <array>
#include <memory>

#include "vulkan/buffer.hpp"

namespace clothbench::render {

/// The render pass (multisampled colour and depth, resolved to one sample) and its two pipelines, for cloth and for
/// colliders, which share a set of buffers.
class Pipelines {
 public:
  static constexpr std::uint32_t kBindings = 6;  ///< as in the shaders
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

}  // namespace clothbench::render

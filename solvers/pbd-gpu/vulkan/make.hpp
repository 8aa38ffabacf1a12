#pragma once
#include <vulkan/vulkan.h>

#include <vector>

#include "vulkan/device.hpp"

namespace clothbench::vulkan {

// Objects that several classes make in the same way. The caller destroys them; each throws Error if Vulkan fails.

/// From the device's command pool.
VkCommandBuffer make_commands(const Device&);
VkFence make_fence(const Device&);
VkQueryPool make_timestamps(const Device&, std::uint32_t count);

/// One set of storage buffers, with its layout and the pool that it lies in. Handles are filled in as they are made.
void make_storage_set(const Device&, const std::vector<VkDescriptorSetLayoutBinding>&, VkDescriptorSetLayout&,
                      VkDescriptorPool&, VkDescriptorSet&);

}  // namespace clothbench::vulkan

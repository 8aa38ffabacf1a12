#include "vulkan/device.hpp"

namespace clothbench::vulkan {

VkCommandBuffer make_commands(const Device& device) {
  VkCommandBufferAllocateInfo allocate{};
  allocate.sType = VK_STRUCTURE_TYPE_COMMAND_BUFFER_ALLOCATE_INFO;
  allocate.commandPool = device.command_pool();
  allocate.level = VK_COMMAND_BUFFER_LEVEL_PRIMARY;
  allocate.commandBufferCount = 1;
  VkCommandBuffer commands = VK_NULL_HANDLE;
  check(vkAllocateCommandBuffers(device.handle(), &allocate, &commands), "vkAllocateCommandBuffers");
  return commands;
}

VkFence make_fence(const Device& device) {
  VkFenceCreateInfo info{};
  info.sType = VK_STRUCTURE_TYPE_FENCE_CREATE_INFO;
  VkFence fence = VK_NULL_HANDLE;
  check(vkCreateFence(device.handle(), &info, nullptr, &fence), "vkCreateFence");
  return fence;
}

VkQueryPool make_timestamps(const Device& device, std::uint32_t count) {
  VkQueryPoolCreateInfo info{};
  info.sType = VK_STRUCTURE_TYPE_QUERY_POOL_CREATE_INFO;
  info.queryType = VK_QUERY_TYPE_TIMESTAMP;
  info.queryCount = count;
  VkQueryPool queries = VK_NULL_HANDLE;
  check(vkCreateQueryPool(device.handle(), &info, nullptr, &queries), "vkCreateQueryPool");
  return queries;
}

void make_storage_set(const Device& device, const std::vector<VkDescriptorSetLayoutBinding>& slots,
                      VkDescriptorSetLayout& layout, VkDescriptorPool& pool, VkDescriptorSet& set) {
  VkDescriptorSetLayoutCreateInfo form{};
  form.sType = VK_STRUCTURE_TYPE_DESCRIPTOR_SET_LAYOUT_CREATE_INFO;
  form.bindingCount = static_cast<std::uint32_t>(slots.size());
  form.pBindings = slots.data();
  check(vkCreateDescriptorSetLayout(device.handle(), &form, nullptr, &layout), "vkCreateDescriptorSetLayout");
  const VkDescriptorPoolSize size{VK_DESCRIPTOR_TYPE_STORAGE_BUFFER, form.bindingCount};
  VkDescriptorPoolCreateInfo room{};
  room.sType = VK_STRUCTURE_TYPE_DESCRIPTOR_POOL_CREATE_INFO;
  room.maxSets = 1;
  room.poolSizeCount = 1;
  room.pPoolSizes = &size;
  check(vkCreateDescriptorPool(device.handle(), &room, nullptr, &pool), "vkCreateDescriptorPool");
  VkDescriptorSetAllocateInfo allocate{};
  allocate.sType = VK_STRUCTURE_TYPE_DESCRIPTOR_SET_ALLOCATE_INFO;
  allocate.descriptorPool = pool;
  allocate.descriptorSetCount = 1;
  allocate.pSetLayouts = &layout;
  check(vkAllocateDescriptorSets(device.handle(), &allocate, &set), "vkAllocateDescriptorSets");
}

}  // namespace clothbench::vulkan

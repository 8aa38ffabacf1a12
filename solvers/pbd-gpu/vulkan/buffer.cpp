#include "vulkan/buffer.hpp"

namespace clothbench::vulkan {

// Delegates, so that the destructor runs if this throws.
Buffer::Buffer(std::shared_ptr<Device> device, std::string name, VkDeviceSize bytes, Place place)
    : Buffer(std::move(device)) {
  name_ = std::move(name);
  bytes_ = bytes;
  place_ = place;
  VkBufferCreateInfo info{};
  info.sType = VK_STRUCTURE_TYPE_BUFFER_CREATE_INFO;
  info.size = bytes_;
  info.usage = VK_BUFFER_USAGE_STORAGE_BUFFER_BIT | VK_BUFFER_USAGE_TRANSFER_SRC_BIT | VK_BUFFER_USAGE_TRANSFER_DST_BIT;
  check(vkCreateBuffer(device_->handle(), &info, nullptr, &buffer_), "vkCreateBuffer");
  VkMemoryRequirements needs{};
  vkGetBufferMemoryRequirements(device_->handle(), buffer_, &needs);

  constexpr VkMemoryPropertyFlags kMapped = VK_MEMORY_PROPERTY_HOST_VISIBLE_BIT | VK_MEMORY_PROPERTY_HOST_COHERENT_BIT;
  VkMemoryAllocateInfo memory{};
  memory.sType = VK_STRUCTURE_TYPE_MEMORY_ALLOCATE_INFO;
  memory.allocationSize = needs.size;
  memory.memoryTypeIndex =
      place_ == Place::Device
          ? device_->memory_type(needs.memoryTypeBits, VK_MEMORY_PROPERTY_DEVICE_LOCAL_BIT)
          // Host-cached memory if there is any, because the host reads positions back through it.
          : device_->memory_type(needs.memoryTypeBits, kMapped | VK_MEMORY_PROPERTY_HOST_CACHED_BIT);
  if (memory.memoryTypeIndex == Device::kNoMemory)
    memory.memoryTypeIndex = device_->memory_type(needs.memoryTypeBits, place_ == Place::Device ? 0 : kMapped);
  check(vkAllocateMemory(device_->handle(), &memory, nullptr, &memory_), "vkAllocateMemory");
  check(vkBindBufferMemory(device_->handle(), buffer_, memory_, 0), "vkBindBufferMemory");
  if (place_ == Place::Host)
    check(vkMapMemory(device_->handle(), memory_, 0, VK_WHOLE_SIZE, 0, &mapped_), "vkMapMemory");
}

Buffer::~Buffer() {
  vkDestroyBuffer(device_->handle(), buffer_, nullptr);
  vkFreeMemory(device_->handle(), memory_, nullptr);
}

}  // namespace clothbench::vulkan

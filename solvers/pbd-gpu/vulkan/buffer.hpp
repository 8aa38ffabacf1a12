#pragma once
#include <memory>
#include <string>

#include "vulkan/device.hpp"

namespace clothbench::vulkan {

/// A storage buffer with memory of its own: on the device, or visible to the host and mapped for its whole life.
class Buffer {
 public:
  enum class Place { Device, Host };
  Buffer(std::shared_ptr<Device> device, std::string name, VkDeviceSize bytes, Place place);
  ~Buffer();
  Buffer(const Buffer&) = delete;
  Buffer& operator=(const Buffer&) = delete;

  VkBuffer handle() const { return buffer_; }
  VkDeviceSize bytes() const { return bytes_; }
  const std::string& name() const { return name_; }
  Place place() const { return place_; }
  void* mapped() const { return mapped_; }  ///< host buffers only

 private:
  explicit Buffer(std::shared_ptr<Device> device) : device_(std::move(device)) {}

  std::shared_ptr<Device> device_;
  std::string name_;
  VkDeviceSize bytes_ = 0;
  Place place_ = Place::Device;
  VkBuffer buffer_ = VK_NULL_HANDLE;
  VkDeviceMemory memory_ = VK_NULL_HANDLE;
  void* mapped_ = nullptr;
};

}  // namespace clothbench::vulkan

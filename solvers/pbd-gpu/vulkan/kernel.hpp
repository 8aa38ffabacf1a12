#pragma once
#include <cstdint>
#include <map>
#include <memory>
#include <set>
#include <string>
#include <vector>

#include "vulkan/device.hpp"

namespace clothbench::vulkan {

/// A storage buffer with its own memory: on the device, or visible to the host and mapped while the buffer exists.
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

struct SpirV {
  const std::uint32_t* words;
  std::size_t bytes;
};

enum class Access { Read, Write, ReadWrite };

/// Accesses of a kernel's code to storage buffers, by binding: loads, stores and atomics through all pointers.
std::map<std::uint32_t, Access> accesses_of(SpirV code);

/// Returns `code` with instructions that count the bytes that it loads from and stores to storage buffers. Each
/// invocation has two sums of its own and adds them at its end to four words of buffer `counter`, from `first_word` on:
/// bytes read, bytes written (each as low and high word). An atomic operation reads and writes its word. Accesses to
/// the bindings `uncounted` are not counted: the counters of barriers, whose number of polls depends on timing.
std::vector<std::uint32_t> with_byte_counters(SpirV code, std::uint32_t counter, std::uint32_t first_word,
                                              const std::set<std::uint32_t>& uncounted);

/// Buffers by binding number, in set 0.
using Buffers = std::map<std::uint32_t, const Buffer*>;

/// A kernel's access to a buffer.
struct Binding {
  std::uint32_t number;
  const Buffer* buffer;
  Access access;
};

/// One compute pipeline, bound to the `buffers` that its code accesses. Throws Error if one of them is missing.
class Kernel {
 public:
  Kernel(std::shared_ptr<Device> device, std::string name, SpirV code, std::vector<std::uint32_t> specialization,
         const Buffers& buffers, std::uint32_t push_bytes);
  ~Kernel();
  Kernel(const Kernel&) = delete;
  Kernel& operator=(const Kernel&) = delete;

  const std::string& name() const { return name_; }
  const std::vector<Binding>& bindings() const { return bindings_; }
  SpirV code() const { return code_; }
  void bind(VkCommandBuffer commands) const;
  void push(VkCommandBuffer commands, const std::vector<std::uint8_t>& constants) const;

 private:
  Kernel(std::shared_ptr<Device> device, std::string name, SpirV code)
      : device_(std::move(device)), name_(std::move(name)), code_(code) {}
  void create_layout(std::uint32_t push_bytes);
  void create_set();
  void create_pipeline(const std::vector<std::uint32_t>& specialization);

  std::shared_ptr<Device> device_;
  std::string name_;
  SpirV code_;  ///< not owned: code is embedded in the library
  std::vector<Binding> bindings_;
  VkDescriptorSetLayout set_layout_ = VK_NULL_HANDLE;
  VkPipelineLayout layout_ = VK_NULL_HANDLE;
  VkDescriptorPool pool_ = VK_NULL_HANDLE;
  VkDescriptorSet set_ = VK_NULL_HANDLE;
  VkPipeline pipeline_ = VK_NULL_HANDLE;
};

struct Groups {
  std::uint32_t x = 0, y = 0;
  bool operator==(const Groups&) const = default;
};

/// Workgroups for `items` items at `group_size` each: one row, or the fewest equal rows if one row would exceed the
/// 65535 workgroups that every device supports. The last row may exceed the items, so kernels check their index. Throws
/// Error for more than 65535 rows, and for more items than 32 bits can number.
Groups groups_for(std::uint64_t items, std::uint32_t group_size);

}  // namespace clothbench::vulkan

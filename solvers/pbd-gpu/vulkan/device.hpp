#pragma once
#include <vulkan/vulkan.h>

#include <atomic>
#include <memory>
#include <mutex>
#include <string>
#include <vector>

#include "clothbench/error.hpp"
#include "clothbench/solver.hpp"

namespace clothbench::vulkan {

/// Thrown for a VkResult that bad input does not cause: lost device, time-out, exhausted memory.
class Failure : public Error {
 public:
  Failure(const char* call, VkResult result);
  VkResult result() const { return result_; }

 private:
  VkResult result_;
};

/// Throws Failure naming the call unless `result` is VK_SUCCESS.
void check(VkResult result, const char* call);

/// Creates the Vulkan objects of a Device instead of Vulkan's own functions: an OpenXR runtime adds extensions that it
/// needs and selects the GPU that drives the headset (XR_KHR_vulkan_enable2).
class Maker {
 public:
  virtual ~Maker() = default;
  virtual VkResult create_instance(const VkInstanceCreateInfo&, VkInstance*) = 0;
  virtual VkPhysicalDevice physical_device(VkInstance) = 0;
  virtual VkResult create_device(VkPhysicalDevice, const VkDeviceCreateInfo&, VkDevice*) = 0;
};

/// Describes a Vulkan 1.1 physical device. The JSON contains identity, driver, subgroup, memory heaps and the limits
/// that affect compute; `vulkaninfo` prints all limits.
DeviceInfo describe(VkPhysicalDevice physical);

/// Instance, device and one compute queue (Vulkan 1.1 core, no required extension). A process has one Device for each
/// (index, validation, profile), shared by all solvers and kept until the process ends.
class Device {
 public:
  /// The device `options.index`, or the best present: discrete, integrated, virtual, then CPU. Throws Error with
  /// ExitCode::NoDevice if there is none, and Error if validation is requested but the layer is missing.
  static std::shared_ptr<Device> get(const DeviceOptions& options);
  /// Makes a new device with `maker`; from then on `get` returns it for these options. The maker chooses the GPU, not
  /// `options.index`. Throws like `get`.
  static std::shared_ptr<Device> make(const DeviceOptions& options, Maker& maker);
  static std::vector<DeviceInfo> list();

  ~Device();
  Device(const Device&) = delete;
  Device& operator=(const Device&) = delete;

  VkInstance instance() const { return instance_; }
  VkPhysicalDevice physical() const { return physical_; }
  VkDevice handle() const { return device_; }
  VkQueue queue() const { return queue_; }
  std::uint32_t queue_family() const { return family_; }
  VkCommandPool command_pool() const { return pool_; }
  /// Limits of the device, reduced to the profile's if there is one.
  const VkPhysicalDeviceLimits& limits() const { return properties_.limits; }
  bool is_software() const { return properties_.deviceType == VK_PHYSICAL_DEVICE_TYPE_CPU; }
  /// Subgroup size if compute shaders can shuffle values between the lanes, vote and ballot; otherwise 0.
  std::uint32_t shuffled_lanes() const { return shuffled_lanes_; }
  bool is_discrete() const { return properties_.deviceType == VK_PHYSICAL_DEVICE_TYPE_DISCRETE_GPU; }
  DeviceInfo info() const;

  /// Memory type that is `allowed` and has all properties `wanted`, or kNoMemory.
  static constexpr std::uint32_t kNoMemory = ~0u;
  std::uint32_t memory_type(std::uint32_t allowed, VkMemoryPropertyFlags wanted) const;

  std::uint64_t memory_B() const;  ///< size of the largest device-local heap

  /// Seconds between two raw timestamps; NaN if the queue has none.
  double seconds(std::uint64_t from, std::uint64_t to) const;
  bool has_timestamps() const { return timestamp_bits_ > 0; }

  int validation_messages() const;
  std::vector<std::string> messages() const;  ///< text of the validation layer's warnings and errors so far
  void note_message(const char* text);
  /// From now on every message also increments `count`. Solvers share a device, so each sets its own count before it
  /// uses the device. Messages from the device's creation are added to the first count.
  void count_messages_in(const std::shared_ptr<std::atomic<int>>& count);

  /// After VK_ERROR_DEVICE_LOST: `get` makes a new device instead of sharing this one.
  void mark_lost() { lost_ = true; }
  bool lost() const { return lost_; }

 private:
  Device() = default;
  Device(const DeviceOptions& options, Maker* maker);
  void apply_profile(const std::string& name);
  void create_instance(bool validation, Maker* maker);
  void choose_physical(int index, Maker* maker);
  void create_device(Maker* maker);

  std::string profile_;  ///< device profile whose limits are imposed; empty: none
  VkInstance instance_ = VK_NULL_HANDLE;
  VkDebugUtilsMessengerEXT messenger_ = VK_NULL_HANDLE;
  VkPhysicalDevice physical_ = VK_NULL_HANDLE;
  VkPhysicalDeviceProperties properties_{};
  VkPhysicalDeviceMemoryProperties memory_{};
  VkDevice device_ = VK_NULL_HANDLE;
  VkQueue queue_ = VK_NULL_HANDLE;
  std::uint32_t family_ = 0, timestamp_bits_ = 0;
  VkCommandPool pool_ = VK_NULL_HANDLE;
  std::uint32_t shuffled_lanes_ = 0;
  std::atomic<bool> lost_{false};
  mutable std::mutex messages_mutex_;
  std::vector<std::string> messages_;
  std::shared_ptr<std::atomic<int>> blamed_;
  int of_making_ = 0;
};

// Objects that several classes make in the same way. The caller destroys them; each throws Error if Vulkan fails.

/// Allocates a command buffer from the device's pool.
VkCommandBuffer make_commands(const Device&);
VkFence make_fence(const Device&);
VkQueryPool make_timestamps(const Device&, std::uint32_t count);

/// Resets a command buffer and begins recording.
void begin(VkCommandBuffer);
/// Submits commands whose recording has ended.
void submit(const Device&, VkCommandBuffer, VkFence);

/// Makes a descriptor set of storage buffers, its layout and its pool. Each handle is set as soon as it exists.
void make_storage_set(const Device&, const std::vector<VkDescriptorSetLayoutBinding>&, VkDescriptorSetLayout&,
                      VkDescriptorPool&, VkDescriptorSet&);

}  // namespace clothbench::vulkan

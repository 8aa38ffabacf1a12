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

/// Creates the Vulkan objects of a Device in place of Vulkan itself: an OpenXR runtime adds extensions that it needs
/// and selects the GPU that drives the headset (XR_KHR_vulkan_enable2).
class Maker {
 public:
  virtual ~Maker() = default;
  virtual VkResult create_instance(const VkInstanceCreateInfo&, VkInstance*) = 0;
  virtual VkPhysicalDevice physical_device(VkInstance) = 0;
  virtual VkResult create_device(VkPhysicalDevice, const VkDeviceCreateInfo&, VkDevice*) = 0;
};

/// A Vulkan 1.1 physical device as DeviceInfo. Its JSON has identity, driver, subgroup, memory heaps and
/// the limits that compute meets; `vulkaninfo` has all others.
DeviceInfo describe(VkPhysicalDevice physical);

/// Instance, device and its one compute queue (Vulkan 1.1 core, no required extension). A process has one for each
/// (index, validation, profile), shared by all solvers and kept until the process ends.
class Device {
 public:
  /// The device `options.index`, or the best present: discrete, integrated, virtual, then CPU. Throws Error with
  /// ExitCode::NoDevice if there is none, and Error if validation is requested but the layer is missing.
  static std::shared_ptr<Device> get(const DeviceOptions& options);
  /// Makes a new device by `maker`; from then on `get` returns it for these options. The maker chooses the GPU, not
  /// `options.index`. Throws as `get`.
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
  /// Lanes of a subgroup that compute shaders can shuffle values between; 0 where they cannot.
  std::uint32_t shuffled_lanes() const { return shuffled_lanes_; }
  bool is_discrete() const { return properties_.deviceType == VK_PHYSICAL_DEVICE_TYPE_DISCRETE_GPU; }
  DeviceInfo info() const;

  /// Memory type with all of `wanted`, or kNoMemory.
  static constexpr std::uint32_t kNoMemory = ~0u;
  std::uint32_t memory_type(std::uint32_t allowed, VkMemoryPropertyFlags wanted) const;

  std::uint64_t memory_B() const;  ///< of its largest heap of its own

  /// Seconds between two raw timestamps; NaN where the queue has none.
  double seconds(std::uint64_t from, std::uint64_t to) const;
  bool has_timestamps() const { return timestamp_bits_ > 0; }

  int validation_messages() const;
  std::vector<std::string> messages() const;  ///< text of the validation layer's warnings and errors so far
  void note_message(const char* text);
  /// From now on every message adds to this count too. Solvers share a device, so each sets its own count before it
  /// uses the device. Messages from making the device go to the first count.
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

  std::string profile_;  ///< the limits of which class of devices it keeps to; empty: its own
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

/// From the device's command pool.
VkCommandBuffer make_commands(const Device&);
VkFence make_fence(const Device&);
VkQueryPool make_timestamps(const Device&, std::uint32_t count);

/// Begins to record anew.
void begin(VkCommandBuffer);
/// Submits commands whose recording has ended.
void submit(const Device&, VkCommandBuffer, VkFence);

/// One set of storage buffers, with its layout and the pool that it lies in. Handles are filled in as they are made.
void make_storage_set(const Device&, const std::vector<VkDescriptorSetLayoutBinding>&, VkDescriptorSetLayout&,
                      VkDescriptorPool&, VkDescriptorSet&);

}  // namespace clothbench::vulkan

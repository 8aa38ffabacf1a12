#include "vulkan/device.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cstdlib>
#include <cstring>
#include <limits>
#include <map>
#include <mutex>
#include <tuple>
#include <utility>

#include "base/json_text.hpp"

namespace clothbench::vulkan {
namespace {

constexpr const char* kValidationLayer = "VK_LAYER_KHRONOS_validation";

/// The only profile: the known limit of the Adreno 740 in a Quest 3 (Mesa, freedreno_devices.py, cs_shared_mem_size).
/// The limit of 256 threads per workgroup is a precaution.
constexpr const char* kProfile = "adreno-like";
constexpr std::uint32_t kProfileShared_B = 32u << 10, kProfileThreads = 256;

VKAPI_ATTR VkBool32 VKAPI_CALL on_message(VkDebugUtilsMessageSeverityFlagBitsEXT, VkDebugUtilsMessageTypeFlagsEXT,
                                          const VkDebugUtilsMessengerCallbackDataEXT* data, void* user) {
  static_cast<Device*>(user)->note_message(data->pMessage);
  return VK_FALSE;
}

std::vector<VkPhysicalDevice> physical_devices(VkInstance instance) {
  std::uint32_t count = 0;
  check(vkEnumeratePhysicalDevices(instance, &count, nullptr), "vkEnumeratePhysicalDevices");
  std::vector<VkPhysicalDevice> found(count);
  check(vkEnumeratePhysicalDevices(instance, &count, found.data()), "vkEnumeratePhysicalDevices");
  return found;
}

std::ptrdiff_t rank(VkPhysicalDeviceType type) {
  constexpr std::array kBest = {VK_PHYSICAL_DEVICE_TYPE_DISCRETE_GPU, VK_PHYSICAL_DEVICE_TYPE_INTEGRATED_GPU,
                                VK_PHYSICAL_DEVICE_TYPE_VIRTUAL_GPU};
  return std::find(kBest.begin(), kBest.end(), type) - kBest.begin();
}

bool layer_present(const char* name) {
  std::uint32_t count = 0;
  vkEnumerateInstanceLayerProperties(&count, nullptr);
  std::vector<VkLayerProperties> layers(count);
  vkEnumerateInstanceLayerProperties(&count, layers.data());
  return std::any_of(layers.begin(), layers.end(), [&](const auto& l) { return std::strcmp(l.layerName, name) == 0; });
}

std::string profile_name(const DeviceOptions& options) {
  const char* from_environment = std::getenv("CLOTHBENCH_DEVICE_PROFILE");
  return !options.profile.empty() ? options.profile : from_environment != nullptr ? from_environment : "";
}

VkApplicationInfo application() {
  VkApplicationInfo app{};
  app.sType = VK_STRUCTURE_TYPE_APPLICATION_INFO;
  app.pApplicationName = "clothbench";
  app.apiVersion = VK_API_VERSION_1_1;
  return app;
}

/// Devices of this process. They are kept until it ends, because drivers fail to load after many reloads (NVIDIA 580:
/// VK_ERROR_INCOMPATIBLE_DRIVER). They are never destroyed, because the driver's own clean-up may come first.
struct Made {
  std::mutex mutex;
  std::map<std::tuple<int, bool, std::string>, std::shared_ptr<Device>> devices;
  std::shared_ptr<Device>& of(const DeviceOptions& o) { return devices[{o.index, o.validation, profile_name(o)}]; }
};

Made& made() {
  static Made& all = *new Made;
  return all;
}

}  // namespace

Failure::Failure(const char* call, VkResult result)
    : Error(fmt::format("{} failed: VkResult {}", call, static_cast<int>(result)), ExitCode::CheckFailed),
      result_(result) {}

void check(VkResult result, const char* call) {
  if (result != VK_SUCCESS) throw Failure(call, result);
}

std::shared_ptr<Device> Device::get(const DeviceOptions& options) {
  const std::lock_guard lock(made().mutex);
  auto& device = made().of(options);
  if (!device || device->lost()) device.reset(new Device(options, nullptr));
  return device;
}

std::shared_ptr<Device> Device::make(const DeviceOptions& options, Maker& maker) {
  const std::lock_guard lock(made().mutex);
  auto& device = made().of(options);
  device.reset(new Device(options, &maker));
  return device;
}

std::vector<DeviceInfo> Device::list() {
  const VkApplicationInfo app = application();
  VkInstanceCreateInfo info{};
  info.sType = VK_STRUCTURE_TYPE_INSTANCE_CREATE_INFO;
  info.pApplicationInfo = &app;
  VkInstance instance = VK_NULL_HANDLE;
  if (vkCreateInstance(&info, nullptr, &instance) != VK_SUCCESS) return {};
  std::vector<DeviceInfo> all;
  try {
    for (VkPhysicalDevice p : physical_devices(instance)) all.push_back(describe(p));
  } catch (...) {
    vkDestroyInstance(instance, nullptr);
    throw;
  }
  vkDestroyInstance(instance, nullptr);
  return all;
}

// Delegates to another constructor, so that the destructor runs if this one throws.
Device::Device(const DeviceOptions& options, Maker* maker) : Device() {
  create_instance(options.validation, maker);
  choose_physical(options.index, maker);
  apply_profile(profile_name(options));
  create_device(maker);
  of_making_ = validation_messages();
}

void Device::create_instance(bool validation, Maker* maker) {
  if (validation && !layer_present(kValidationLayer))
    throw Error(std::string("validation was requested, but ") + kValidationLayer +
                " is not installed (Debian: vulkan-validationlayers)");
  const VkApplicationInfo app = application();
  const VkValidationFeatureEnableEXT enable = VK_VALIDATION_FEATURE_ENABLE_SYNCHRONIZATION_VALIDATION_EXT;
  VkValidationFeaturesEXT features{};
  features.sType = VK_STRUCTURE_TYPE_VALIDATION_FEATURES_EXT;
  features.enabledValidationFeatureCount = 1;
  features.pEnabledValidationFeatures = &enable;
  VkDebugUtilsMessengerCreateInfoEXT messenger{};
  messenger.sType = VK_STRUCTURE_TYPE_DEBUG_UTILS_MESSENGER_CREATE_INFO_EXT;
  messenger.messageSeverity =
      VK_DEBUG_UTILS_MESSAGE_SEVERITY_WARNING_BIT_EXT | VK_DEBUG_UTILS_MESSAGE_SEVERITY_ERROR_BIT_EXT;
  messenger.messageType =
      VK_DEBUG_UTILS_MESSAGE_TYPE_VALIDATION_BIT_EXT | VK_DEBUG_UTILS_MESSAGE_TYPE_PERFORMANCE_BIT_EXT;
  messenger.pfnUserCallback = on_message;
  messenger.pUserData = this;
  const std::array names = {VK_EXT_DEBUG_UTILS_EXTENSION_NAME, VK_EXT_VALIDATION_FEATURES_EXTENSION_NAME};

  VkInstanceCreateInfo info{};
  info.sType = VK_STRUCTURE_TYPE_INSTANCE_CREATE_INFO;
  info.pApplicationInfo = &app;
  if (validation) {
    info.pNext = &features;
    info.enabledLayerCount = 1;
    info.ppEnabledLayerNames = &kValidationLayer;
    info.enabledExtensionCount = static_cast<std::uint32_t>(names.size());
    info.ppEnabledExtensionNames = names.data();
  }
  const VkResult result =
      maker != nullptr ? maker->create_instance(info, &instance_) : vkCreateInstance(&info, nullptr, &instance_);
  if (result != VK_SUCCESS)
    throw Error(
        fmt::format(
            "no Vulkan instance: vkCreateInstance gave {}; is a driver installed? (Debian: mesa-vulkan-drivers)",
            static_cast<int>(result)),
        ExitCode::NoDevice);
  if (!validation) return;
  const auto create = reinterpret_cast<PFN_vkCreateDebugUtilsMessengerEXT>(
      vkGetInstanceProcAddr(instance_, "vkCreateDebugUtilsMessengerEXT"));
  check(create(instance_, &messenger, nullptr, &messenger_), "vkCreateDebugUtilsMessengerEXT");
}

void Device::choose_physical(int index, Maker* maker) {
  const std::vector<VkPhysicalDevice> all =
      maker != nullptr ? std::vector{maker->physical_device(instance_)} : physical_devices(instance_);
  if (maker != nullptr) index = 0;
  if (all.empty()) throw Error("no Vulkan device; install a driver (Debian: mesa-vulkan-drivers)", ExitCode::NoDevice);
  if (index >= static_cast<int>(all.size()))
    throw Error(fmt::format("device {}: there are {} Vulkan devices (the first is 0)", index, all.size()),
                ExitCode::NoDevice);
  if (index >= 0) {
    physical_ = all[static_cast<std::size_t>(index)];
  } else {
    const auto rank_of = [](VkPhysicalDevice p) {
      VkPhysicalDeviceProperties properties;
      vkGetPhysicalDeviceProperties(p, &properties);
      return rank(properties.deviceType);
    };
    physical_ = *std::min_element(all.begin(), all.end(), [&](auto a, auto b) { return rank_of(a) < rank_of(b); });
  }
  vkGetPhysicalDeviceMemoryProperties(physical_, &memory_);
  VkPhysicalDeviceSubgroupProperties subgroup{};
  subgroup.sType = VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_SUBGROUP_PROPERTIES;
  VkPhysicalDeviceProperties2 properties{VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_PROPERTIES_2, &subgroup, {}};
  vkGetPhysicalDeviceProperties2(physical_, &properties);
  properties_ = properties.properties;
  constexpr VkSubgroupFeatureFlags kNeeded =
      VK_SUBGROUP_FEATURE_VOTE_BIT | VK_SUBGROUP_FEATURE_BALLOT_BIT | VK_SUBGROUP_FEATURE_SHUFFLE_BIT;
  const bool shuffles = (subgroup.supportedStages & VK_SHADER_STAGE_COMPUTE_BIT) != 0 &&
                        (subgroup.supportedOperations & kNeeded) == kNeeded;
  shuffled_lanes_ = shuffles ? subgroup.subgroupSize : 0;
}

void Device::apply_profile(const std::string& name) {
  if (name.empty()) return;
  if (name != kProfile) throw Error("device profile \"" + name + "\": expected " + kProfile);
  profile_ = name;
  VkPhysicalDeviceLimits& l = properties_.limits;
  l.maxComputeSharedMemorySize = std::min(l.maxComputeSharedMemorySize, kProfileShared_B);
  l.maxComputeWorkGroupInvocations = std::min(l.maxComputeWorkGroupInvocations, kProfileThreads);
  l.maxComputeWorkGroupSize[0] = std::min(l.maxComputeWorkGroupSize[0], kProfileThreads);
  l.maxComputeWorkGroupSize[1] = l.maxComputeWorkGroupSize[2] = 1;
}

void Device::create_device(Maker* maker) {
  std::uint32_t count = 0;
  vkGetPhysicalDeviceQueueFamilyProperties(physical_, &count, nullptr);
  std::vector<VkQueueFamilyProperties> families(count);
  vkGetPhysicalDeviceQueueFamilyProperties(physical_, &count, families.data());
  while (family_ < count && (families[family_].queueFlags & VK_QUEUE_COMPUTE_BIT) == 0) ++family_;
  if (family_ == count) throw Error(std::string(properties_.deviceName) + ": no compute queue", ExitCode::NoDevice);
  timestamp_bits_ = families[family_].timestampValidBits;

  const float priority = 1;
  VkDeviceQueueCreateInfo queue{};
  queue.sType = VK_STRUCTURE_TYPE_DEVICE_QUEUE_CREATE_INFO;
  queue.queueFamilyIndex = family_;
  queue.queueCount = 1;
  queue.pQueuePriorities = &priority;
  VkDeviceCreateInfo info{};
  info.sType = VK_STRUCTURE_TYPE_DEVICE_CREATE_INFO;
  info.queueCreateInfoCount = 1;
  info.pQueueCreateInfos = &queue;

  check(maker != nullptr ? maker->create_device(physical_, info, &device_)
                         : vkCreateDevice(physical_, &info, nullptr, &device_),
        "vkCreateDevice");
  vkGetDeviceQueue(device_, family_, 0, &queue_);

  VkCommandPoolCreateInfo pool{};
  pool.sType = VK_STRUCTURE_TYPE_COMMAND_POOL_CREATE_INFO;
  pool.flags = VK_COMMAND_POOL_CREATE_RESET_COMMAND_BUFFER_BIT;
  pool.queueFamilyIndex = family_;
  check(vkCreateCommandPool(device_, &pool, nullptr, &pool_), "vkCreateCommandPool");
}

Device::~Device() {
  if (device_ != VK_NULL_HANDLE) {
    vkDeviceWaitIdle(device_);
    vkDestroyCommandPool(device_, pool_, nullptr);
    vkDestroyDevice(device_, nullptr);
  }
  if (messenger_ != VK_NULL_HANDLE) {
    const auto destroy = reinterpret_cast<PFN_vkDestroyDebugUtilsMessengerEXT>(
        vkGetInstanceProcAddr(instance_, "vkDestroyDebugUtilsMessengerEXT"));
    destroy(instance_, messenger_, nullptr);
  }
  if (instance_ != VK_NULL_HANDLE) vkDestroyInstance(instance_, nullptr);
}

DeviceInfo Device::info() const {
  DeviceInfo info = describe(physical_);
  if (profile_.empty()) return info;
  // Results under a profile must not be mistaken for results of the device itself.
  info.name += " [" + profile_ + "]";
  nlohmann::json j = json_from(info.properties_json);
  j["device_profile"] = profile_;
  info.properties_json = dump(j);
  return info;
}

std::uint64_t Device::memory_B() const {
  std::uint64_t most = 0;
  for (std::uint32_t i = 0; i < memory_.memoryHeapCount; ++i)
    if ((memory_.memoryHeaps[i].flags & VK_MEMORY_HEAP_DEVICE_LOCAL_BIT) != 0)
      most = std::max<std::uint64_t>(most, memory_.memoryHeaps[i].size);
  return most;
}

std::uint32_t Device::memory_type(std::uint32_t allowed, VkMemoryPropertyFlags wanted) const {
  for (std::uint32_t i = 0; i < memory_.memoryTypeCount; ++i)
    if ((allowed >> i & 1u) != 0 && (memory_.memoryTypes[i].propertyFlags & wanted) == wanted) return i;
  return kNoMemory;
}

double Device::seconds(std::uint64_t from, std::uint64_t to) const {
  if (timestamp_bits_ == 0) return std::numeric_limits<double>::quiet_NaN();
  const std::uint64_t mask = timestamp_bits_ >= 64 ? ~std::uint64_t{0} : (std::uint64_t{1} << timestamp_bits_) - 1;
  return static_cast<double>((to - from) & mask) * static_cast<double>(properties_.limits.timestampPeriod) * 1e-9;
}

int Device::validation_messages() const {
  const std::lock_guard lock(messages_mutex_);
  return static_cast<int>(messages_.size());
}

std::vector<std::string> Device::messages() const {
  const std::lock_guard lock(messages_mutex_);
  return messages_;
}

void Device::count_messages_in(const std::shared_ptr<std::atomic<int>>& count) {
  const std::lock_guard lock(messages_mutex_);
  *count += std::exchange(of_making_, 0);
  blamed_ = count;
}

void Device::note_message(const char* text) {
  const std::lock_guard lock(messages_mutex_);
  messages_.emplace_back(text);
  if (blamed_) ++*blamed_;
  fmt::print(stderr, "[vulkan] {}\n", text);
}

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

void begin(VkCommandBuffer commands) {
  check(vkResetCommandBuffer(commands, 0), "vkResetCommandBuffer");
  VkCommandBufferBeginInfo info{};
  info.sType = VK_STRUCTURE_TYPE_COMMAND_BUFFER_BEGIN_INFO;
  check(vkBeginCommandBuffer(commands, &info), "vkBeginCommandBuffer");
}

void submit(const Device& device, VkCommandBuffer commands, VkFence fence) {
  VkSubmitInfo info{};
  info.sType = VK_STRUCTURE_TYPE_SUBMIT_INFO;
  info.commandBufferCount = 1;
  info.pCommandBuffers = &commands;
  check(vkQueueSubmit(device.queue(), 1, &info, fence), "vkQueueSubmit");
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

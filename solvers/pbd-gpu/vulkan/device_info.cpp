#include <fmt/format.h>

#include <nlohmann/json.hpp>
#include <vector>

#include "vulkan/device.hpp"

namespace clothbench::vulkan {
namespace {

std::string hexadecimal(const std::uint8_t (&bytes)[VK_UUID_SIZE]) {
  std::string text;
  for (std::uint8_t b : bytes) text += fmt::format("{:02x}", b);
  return text;
}

nlohmann::json queue_families(VkPhysicalDevice physical) {
  std::uint32_t count = 0;
  vkGetPhysicalDeviceQueueFamilyProperties(physical, &count, nullptr);
  std::vector<VkQueueFamilyProperties> families(count);
  vkGetPhysicalDeviceQueueFamilyProperties(physical, &count, families.data());
  nlohmann::json j = nlohmann::json::array();
  for (const auto& f : families)
    j.push_back({{"flags", f.queueFlags}, {"count", f.queueCount}, {"timestampValidBits", f.timestampValidBits}});
  return j;
}

nlohmann::json limits(const VkPhysicalDeviceLimits& l) {
  return {{"maxStorageBufferRange", l.maxStorageBufferRange},
          {"maxPushConstantsSize", l.maxPushConstantsSize},
          {"maxComputeSharedMemorySize", l.maxComputeSharedMemorySize},
          {"maxComputeWorkGroupCount", l.maxComputeWorkGroupCount},
          {"maxComputeWorkGroupInvocations", l.maxComputeWorkGroupInvocations},
          {"maxComputeWorkGroupSize", l.maxComputeWorkGroupSize},
          {"timestampPeriod", l.timestampPeriod}};
}

}  // namespace

DeviceInfo describe(VkPhysicalDevice physical) {
  VkPhysicalDeviceDriverProperties driver{};
  driver.sType = VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_DRIVER_PROPERTIES;
  VkPhysicalDeviceIDProperties id{};
  id.sType = VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_ID_PROPERTIES;
  VkPhysicalDeviceSubgroupProperties subgroup{};
  subgroup.sType = VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_SUBGROUP_PROPERTIES;
  subgroup.pNext = &id;
  VkPhysicalDeviceProperties2 all{VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_PROPERTIES_2, &subgroup, {}};
  vkGetPhysicalDeviceProperties2(physical, &all);
  const VkPhysicalDeviceProperties& p = all.properties;
  if (p.apiVersion >= VK_API_VERSION_1_2) {  // where driver properties are part of Vulkan
    id.pNext = &driver;
    vkGetPhysicalDeviceProperties2(physical, &all);
  }
  VkPhysicalDeviceMemoryProperties memory{};
  vkGetPhysicalDeviceMemoryProperties(physical, &memory);

  nlohmann::json j = {{"vendor_id", p.vendorID},
                      {"device_id", p.deviceID},
                      {"device_type", p.deviceType},
                      {"device_uuid", hexadecimal(id.deviceUUID)},
                      {"driver_uuid", hexadecimal(id.driverUUID)},
                      {"driver_version_raw", p.driverVersion},
                      {"driver_name", driver.driverName},
                      {"driver_info", driver.driverInfo},
                      {"subgroup_size", subgroup.subgroupSize},
                      {"subgroup_stages", subgroup.supportedStages},
                      {"subgroup_operations", subgroup.supportedOperations},
                      {"limits", limits(p.limits)},
                      {"queue_families", queue_families(physical)}};
  for (std::uint32_t i = 0; i < memory.memoryHeapCount; ++i)
    j["memory_heaps"].push_back({{"bytes", memory.memoryHeaps[i].size}, {"flags", memory.memoryHeaps[i].flags}});

  DeviceInfo info;
  info.name = p.deviceName;
  info.driver = driver.driverName[0] != '\0' ? fmt::format("{} {}", driver.driverName, driver.driverInfo)
                                             : fmt::format("version {:#x}", p.driverVersion);
  info.api = fmt::format("Vulkan {}.{}.{}", VK_API_VERSION_MAJOR(p.apiVersion), VK_API_VERSION_MINOR(p.apiVersion),
                         VK_API_VERSION_PATCH(p.apiVersion));
  info.is_software = p.deviceType == VK_PHYSICAL_DEVICE_TYPE_CPU;
  info.properties_json = j.dump();
  return info;
}

}  // namespace clothbench::vulkan

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "base/json_text.hpp"
#include "vulkan/device.hpp"

namespace clothbench::vulkan {

DeviceInfo describe(VkPhysicalDevice physical) {
  VkPhysicalDeviceDriverProperties driver{};
  driver.sType = VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_DRIVER_PROPERTIES;
  VkPhysicalDeviceSubgroupProperties subgroup{};
  subgroup.sType = VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_SUBGROUP_PROPERTIES;
  VkPhysicalDeviceIDProperties id{};
  id.sType = VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_ID_PROPERTIES;
  id.pNext = &subgroup;
  VkPhysicalDeviceProperties2 all{VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_PROPERTIES_2, &id, {}};
  vkGetPhysicalDeviceProperties2(physical, &all);
  const VkPhysicalDeviceProperties& p = all.properties;
  const VkPhysicalDeviceLimits& l = p.limits;
  if (p.apiVersion >= VK_API_VERSION_1_2) {  // driver properties are core from 1.2 on
    subgroup.pNext = &driver;
    vkGetPhysicalDeviceProperties2(physical, &all);
  }
  VkPhysicalDeviceMemoryProperties memory{};
  vkGetPhysicalDeviceMemoryProperties(physical, &memory);

  nlohmann::json j = {{"vendor_id", p.vendorID},          {"device_id", p.deviceID},
                      {"device_type", p.deviceType},      {"driver_name", driver.driverName},
                      {"driver_info", driver.driverInfo}, {"subgroup_size", subgroup.subgroupSize}};
  j["limits"] = {{"maxStorageBufferRange", l.maxStorageBufferRange},
                 {"maxPushConstantsSize", l.maxPushConstantsSize},
                 {"maxComputeSharedMemorySize", l.maxComputeSharedMemorySize},
                 {"maxComputeWorkGroupCount", l.maxComputeWorkGroupCount},
                 {"maxComputeWorkGroupInvocations", l.maxComputeWorkGroupInvocations},
                 {"maxComputeWorkGroupSize", l.maxComputeWorkGroupSize},
                 {"timestampPeriod", l.timestampPeriod}};
  j["uuid"] = fmt::format("{:02x}", fmt::join(id.deviceUUID, ""));
  for (std::uint32_t i = 0; i < memory.memoryHeapCount; ++i)
    j["memory_heaps"].push_back({{"bytes", memory.memoryHeaps[i].size}, {"flags", memory.memoryHeaps[i].flags}});

  DeviceInfo info;
  info.name = p.deviceName;
  info.driver = driver.driverName[0] != '\0' ? fmt::format("{} {}", driver.driverName, driver.driverInfo)
                                             : fmt::format("version {:#x}", p.driverVersion);
  info.api = fmt::format("Vulkan {}.{}.{}", VK_API_VERSION_MAJOR(p.apiVersion), VK_API_VERSION_MINOR(p.apiVersion),
                         VK_API_VERSION_PATCH(p.apiVersion));
  info.is_software = p.deviceType == VK_PHYSICAL_DEVICE_TYPE_CPU;
  info.properties_json = dump(j);
  return info;
}

}  // namespace clothbench::vulkan

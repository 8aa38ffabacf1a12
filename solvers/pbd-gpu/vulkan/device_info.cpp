#include "vulkan/device_info.hpp"

#include <fmt/format.h>

#include <nlohmann/json.hpp>

namespace clothbench::vulkan {

std::vector<std::string> extensions(VkPhysicalDevice physical) {
  std::uint32_t count = 0;
  vkEnumerateDeviceExtensionProperties(physical, nullptr, &count, nullptr);
  std::vector<VkExtensionProperties> found(count);
  vkEnumerateDeviceExtensionProperties(physical, nullptr, &count, found.data());
  std::vector<std::string> names;
  for (const auto& e : found) names.emplace_back(e.extensionName);
  return names;
}

DeviceInfo describe(VkPhysicalDevice physical) {
  VkPhysicalDeviceSubgroupProperties subgroup{
      VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_SUBGROUP_PROPERTIES, nullptr, 0, 0, 0, VK_FALSE};
  VkPhysicalDeviceDriverProperties driver{};
  driver.sType = VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_DRIVER_PROPERTIES;
  VkPhysicalDeviceProperties2 all{VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_PROPERTIES_2, &subgroup, {}};
  vkGetPhysicalDeviceProperties2(physical, &all);
  const VkPhysicalDeviceProperties& p = all.properties;
  if (p.apiVersion >= VK_API_VERSION_1_2) {
    subgroup.pNext = &driver;
    vkGetPhysicalDeviceProperties2(physical, &all);
  }
  VkPhysicalDeviceMemoryProperties memory{};
  vkGetPhysicalDeviceMemoryProperties(physical, &memory);

  nlohmann::json j;
  j["vendor_id"] = p.vendorID;
  j["device_id"] = p.deviceID;
  j["device_type"] = p.deviceType;
  j["driver_version_raw"] = p.driverVersion;
  j["driver_name"] = driver.driverName;
  j["driver_info"] = driver.driverInfo;
  j["subgroup_size"] = subgroup.subgroupSize;
  j["subgroup_operations"] = subgroup.supportedOperations;
  j["limits"] = limits_json(p.limits);
  for (std::uint32_t i = 0; i < memory.memoryHeapCount; ++i)
    j["memory_heaps"].push_back({{"bytes", memory.memoryHeaps[i].size}, {"flags", memory.memoryHeaps[i].flags}});
  j["extensions"] = extensions(physical);

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

#include "vulkan/device_info.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <nlohmann/json.hpp>

namespace clothbench::vulkan {

namespace {

std::vector<VkExtensionProperties> extension_properties(VkPhysicalDevice physical) {
  std::uint32_t count = 0;
  vkEnumerateDeviceExtensionProperties(physical, nullptr, &count, nullptr);
  std::vector<VkExtensionProperties> found(count);
  vkEnumerateDeviceExtensionProperties(physical, nullptr, &count, found.data());
  return found;
}

std::string hexadecimal(const std::uint8_t (&bytes)[VK_UUID_SIZE]) {
  std::string text;
  for (std::uint8_t b : bytes) text += fmt::format("{:02x}", b);
  return text;
}

}  // namespace

std::vector<std::string> extensions(VkPhysicalDevice physical) {
  std::vector<std::string> names;
  for (const auto& e : extension_properties(physical)) names.emplace_back(e.extensionName);
  return names;
}

DeviceInfo describe(VkPhysicalDevice physical) {
  VkPhysicalDeviceSubgroupProperties subgroup{
      VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_SUBGROUP_PROPERTIES, nullptr, 0, 0, 0, VK_FALSE};
  VkPhysicalDeviceDriverProperties driver{};
  driver.sType = VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_DRIVER_PROPERTIES;
  VkPhysicalDeviceIDProperties id{};
  id.sType = VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_ID_PROPERTIES;
  VkPhysicalDeviceMaintenance3Properties maintenance{};
  maintenance.sType = VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_MAINTENANCE_3_PROPERTIES;
  VkPhysicalDeviceSubgroupSizeControlProperties sizes{};
  sizes.sType = VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_SUBGROUP_SIZE_CONTROL_PROPERTIES;
  subgroup.pNext = &id;
  id.pNext = &maintenance;
  VkPhysicalDeviceProperties2 all{VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_PROPERTIES_2, &subgroup, {}};
  vkGetPhysicalDeviceProperties2(physical, &all);
  const VkPhysicalDeviceProperties& p = all.properties;
  const std::vector<std::string> names = extensions(physical);
  const auto has = [&](const char* name) { return std::find(names.begin(), names.end(), name) != names.end(); };
  void** end = &maintenance.pNext;
  if (p.apiVersion >= VK_API_VERSION_1_2 || has(VK_KHR_DRIVER_PROPERTIES_EXTENSION_NAME)) {
    *end = &driver;
    end = &driver.pNext;
  }
  if (has(VK_EXT_SUBGROUP_SIZE_CONTROL_EXTENSION_NAME)) *end = &sizes;
  vkGetPhysicalDeviceProperties2(physical, &all);
  VkPhysicalDeviceMemoryProperties memory{};
  vkGetPhysicalDeviceMemoryProperties(physical, &memory);

  nlohmann::json j;
  j["vendor_id"] = p.vendorID;
  j["device_id"] = p.deviceID;
  j["api_version_raw"] = p.apiVersion;
  j["pipeline_cache_uuid"] = hexadecimal(p.pipelineCacheUUID);
  j["device_uuid"] = hexadecimal(id.deviceUUID);
  j["driver_uuid"] = hexadecimal(id.driverUUID);
  j["max_memory_allocation_B"] = maintenance.maxMemoryAllocationSize;
  j["max_per_set_descriptors"] = maintenance.maxPerSetDescriptors;
  j["device_type"] = p.deviceType;
  j["driver_version_raw"] = p.driverVersion;
  j["driver_name"] = driver.driverName;
  j["driver_info"] = driver.driverInfo;
  j["subgroup_size"] = subgroup.subgroupSize;
  if (sizes.maxSubgroupSize > 0) {
    j["subgroup_size_min"] = sizes.minSubgroupSize;
    j["subgroup_size_max"] = sizes.maxSubgroupSize;
  }
  j["subgroup_stages"] = subgroup.supportedStages;
  j["subgroup_operations"] = subgroup.supportedOperations;
  j["limits"] = limits_json(p.limits);
  for (std::uint32_t i = 0; i < memory.memoryHeapCount; ++i)
    j["memory_heaps"].push_back({{"bytes", memory.memoryHeaps[i].size}, {"flags", memory.memoryHeaps[i].flags}});
  for (std::uint32_t i = 0; i < memory.memoryTypeCount; ++i)
    j["memory_types"].push_back(
        {{"heap", memory.memoryTypes[i].heapIndex}, {"flags", memory.memoryTypes[i].propertyFlags}});
  j["features"] = features_json(physical);
  j["queue_families"] = queue_families_json(physical);
  j["extensions"] = names;
  for (const auto& e : extension_properties(physical)) j["extension_versions"][e.extensionName] = e.specVersion;

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

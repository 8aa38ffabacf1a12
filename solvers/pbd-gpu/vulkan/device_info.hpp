#pragma once
#include <vulkan/vulkan.h>

#include <nlohmann/json_fwd.hpp>
#include <string>
#include <vector>

#include "clothbench/solver.hpp"

namespace clothbench::vulkan {

/// All properties of a Vulkan 1.1 physical device that matter to compute, as DeviceInfo. Its JSON has limits, features,
/// queue families, memory heaps and types, subgroup, identity and driver properties, extensions and their versions.
DeviceInfo describe(VkPhysicalDevice physical);

/// Every limit of the device.
nlohmann::json limits_json(const VkPhysicalDeviceLimits& limits);

/// Features of Vulkan 1.0, and those of 1.1 and of extensions that kernels could use.
nlohmann::json features_json(VkPhysicalDevice physical);
nlohmann::json queue_families_json(VkPhysicalDevice physical);

/// Names of the device's extensions.
std::vector<std::string> extensions(VkPhysicalDevice physical);

}  // namespace clothbench::vulkan

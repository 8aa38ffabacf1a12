#pragma once
#include <vulkan/vulkan.h>

#include <nlohmann/json_fwd.hpp>

#include "clothbench/solver.hpp"

namespace clothbench::vulkan {

/// Everything the VkPhysicalDevice chain of Vulkan 1.1 tells, as DeviceInfo with a JSON of limits, memory heaps,
/// subgroup and driver properties and extensions.
DeviceInfo describe(VkPhysicalDevice physical);

/// Every limit of the device.
nlohmann::json limits_json(const VkPhysicalDeviceLimits& limits);

/// Names of the device's extensions.
std::vector<std::string> extensions(VkPhysicalDevice physical);

}  // namespace clothbench::vulkan

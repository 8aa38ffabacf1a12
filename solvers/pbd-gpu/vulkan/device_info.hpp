#pragma once
#include <vulkan/vulkan.h>

#include "clothbench/solver.hpp"

namespace clothbench::vulkan {

/// A Vulkan 1.1 physical device as DeviceInfo. Its JSON has identity, driver, subgroup, memory heaps, queue families,
/// and the limits that compute meets; `vulkaninfo` has all others.
DeviceInfo describe(VkPhysicalDevice physical);

}  // namespace clothbench::vulkan

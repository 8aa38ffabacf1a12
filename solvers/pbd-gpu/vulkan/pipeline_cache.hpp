#pragma once
#include <vulkan/vulkan.h>

#include <cstdint>
#include <filesystem>
#include <vector>

namespace clothbench::vulkan {

/// Where compiled pipelines of this device and driver are kept between processes: $CLOTHBENCH_CACHE, else
/// $XDG_CACHE_HOME/clothbench, else ~/.cache/clothbench. Empty where none of them is set, or CLOTHBENCH_CACHE is empty.
std::filesystem::path pipeline_cache_file(const VkPhysicalDeviceProperties&);

/// What the file holds, or nothing where it is missing, torn or of another device or driver (the header of Vulkan 1.1,
/// 9.6.5): a cache may be lost, never wrong.
std::vector<std::uint8_t> read_pipeline_cache(const std::filesystem::path&, const VkPhysicalDeviceProperties&);

/// Writes beside the file and renames, so that no reader sees half of it. False if that fails.
bool write_pipeline_cache(const std::filesystem::path&, const std::vector<std::uint8_t>& data);

}  // namespace clothbench::vulkan

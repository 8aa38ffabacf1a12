#pragma once
#include <vulkan/vulkan.h>

#include <cstdint>
#include <filesystem>
#include <vector>

namespace clothbench::vulkan {

/// File that keeps compiled pipelines of this device and driver between processes: in $CLOTHBENCH_CACHE, else in
/// $XDG_CACHE_HOME/clothbench, else in ~/.cache/clothbench. Empty if none is set, or if CLOTHBENCH_CACHE is empty.
std::filesystem::path pipeline_cache_file(const VkPhysicalDeviceProperties&);

/// The file's contents. Empty if the file is missing, incomplete or of another device or driver (header of Vulkan 1.1,
/// 9.6.5): a cache may be lost, but never wrong.
std::vector<std::uint8_t> read_pipeline_cache(const std::filesystem::path&, const VkPhysicalDeviceProperties&);

/// Writes a file beside it and renames that, so that readers never see a partial file. False if that fails.
bool write_pipeline_cache(const std::filesystem::path&, const std::vector<std::uint8_t>& data);

}  // namespace clothbench::vulkan

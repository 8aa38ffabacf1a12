#include "vulkan/pipeline_cache.hpp"

#include <fmt/format.h>
#include <unistd.h>

#include <cstdlib>
#include <cstring>
#include <fstream>
#include <iterator>

namespace clothbench::vulkan {
namespace {

/// Vulkan 1.1, table 9.1.
struct Header {
  std::uint32_t bytes, version, vendor, device;
  std::uint8_t uuid[VK_UUID_SIZE];
};
static_assert(sizeof(Header) == 32);

}  // namespace

std::filesystem::path pipeline_cache_file(const VkPhysicalDeviceProperties& device) {
  std::filesystem::path folder;
  if (const char* own = std::getenv("CLOTHBENCH_CACHE"))
    folder = own;
  else if (const char* cache = std::getenv("XDG_CACHE_HOME"); cache != nullptr && *cache != 0)
    folder = std::filesystem::path(cache) / "clothbench";
  else if (const char* home = std::getenv("HOME"); home != nullptr && *home != 0)
    folder = std::filesystem::path(home) / ".cache" / "clothbench";
  if (folder.empty()) return {};  // no cache; also if CLOTHBENCH_CACHE is empty
  std::string uuid;
  for (const std::uint8_t byte : device.pipelineCacheUUID) uuid += fmt::format("{:02x}", byte);
  return folder / fmt::format("pipelines-{:04x}-{:04x}-{}.bin", device.vendorID, device.deviceID, uuid);
}

std::vector<std::uint8_t> read_pipeline_cache(const std::filesystem::path& file,
                                              const VkPhysicalDeviceProperties& device) {
  if (file.empty()) return {};
  std::ifstream in(file, std::ios::binary);
  std::vector<std::uint8_t> data(std::istreambuf_iterator<char>(in), {});
  Header header;
  if (data.size() < sizeof header) return {};
  std::memcpy(&header, data.data(), sizeof header);
  const bool ours = header.bytes == sizeof header && header.version == VK_PIPELINE_CACHE_HEADER_VERSION_ONE &&
                    header.vendor == device.vendorID && header.device == device.deviceID &&
                    std::memcmp(header.uuid, device.pipelineCacheUUID, VK_UUID_SIZE) == 0;
  return ours ? data : std::vector<std::uint8_t>{};
}

bool write_pipeline_cache(const std::filesystem::path& file, const std::vector<std::uint8_t>& data) {
  if (file.empty()) return false;
  std::error_code error;
  std::filesystem::create_directories(file.parent_path(), error);
  if (error) return false;
  const std::filesystem::path beside = file.string() + fmt::format(".{}", getpid());
  {
    std::ofstream out(beside, std::ios::binary);
    out.write(reinterpret_cast<const char*>(data.data()), static_cast<std::streamsize>(data.size()));
    if (!out.flush()) {
      std::filesystem::remove(beside, error);
      return false;
    }
  }
  std::filesystem::rename(beside, file, error);
  if (error) std::filesystem::remove(beside, error);
  return !error;
}

}  // namespace clothbench::vulkan

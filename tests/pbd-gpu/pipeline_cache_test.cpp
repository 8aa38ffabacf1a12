// Compiled pipelines kept between processes: only those of the very device and driver are used. No device.
#include "vulkan/pipeline_cache.hpp"

#include <gtest/gtest.h>
#include <unistd.h>

#include <cstdlib>
#include <cstring>

namespace clothbench::vulkan {
namespace {

class PipelineCache : public ::testing::Test {
 protected:
  void SetUp() override {
    // Each test is a process of its own, and several run at once: a fixed name would be shared between them.
    folder_ = std::filesystem::path(::testing::TempDir()) / ("clothbench-pipelines-" + std::to_string(::getpid()));
    std::filesystem::remove_all(folder_);
    setenv("CLOTHBENCH_CACHE", folder_.c_str(), 1);
    device_.vendorID = 0x10de;
    device_.deviceID = 0x2335;
    for (std::uint8_t k = 0; k < VK_UUID_SIZE; ++k) device_.pipelineCacheUUID[k] = k;
  }
  void TearDown() override {
    unsetenv("CLOTHBENCH_CACHE");
    std::filesystem::remove_all(folder_);
  }

  static std::vector<std::uint8_t> of(const VkPhysicalDeviceProperties& d) {
    std::vector<std::uint8_t> data(100, 7);
    const std::uint32_t head[4] = {32, VK_PIPELINE_CACHE_HEADER_VERSION_ONE, d.vendorID, d.deviceID};
    std::memcpy(data.data(), head, 16);
    std::memcpy(data.data() + 16, d.pipelineCacheUUID, VK_UUID_SIZE);
    return data;
  }

  std::filesystem::path folder_;
  VkPhysicalDeviceProperties device_{};
};

TEST_F(PipelineCache, ComesBackAsItWas) {
  const auto file = pipeline_cache_file(device_);
  EXPECT_EQ(file.parent_path(), folder_);
  EXPECT_TRUE(read_pipeline_cache(file, device_).empty()) << "none yet";
  ASSERT_TRUE(write_pipeline_cache(file, of(device_)));
  EXPECT_EQ(read_pipeline_cache(file, device_), of(device_));
  EXPECT_EQ(std::distance(std::filesystem::directory_iterator(folder_), {}), 1) << "nothing is left beside it";
}

TEST_F(PipelineCache, OfAnotherDeviceOrDriverOrTornIsNone) {
  const auto file = pipeline_cache_file(device_);
  VkPhysicalDeviceProperties other = device_;
  other.pipelineCacheUUID[3] ^= 1;
  EXPECT_NE(pipeline_cache_file(other), file) << "another driver, another file";
  ASSERT_TRUE(write_pipeline_cache(file, of(other)));
  EXPECT_TRUE(read_pipeline_cache(file, device_).empty());
  auto torn = of(device_);
  torn.resize(20);
  ASSERT_TRUE(write_pipeline_cache(file, torn));
  EXPECT_TRUE(read_pipeline_cache(file, device_).empty());
}

TEST_F(PipelineCache, IsGoneWithoutAPlace) {
  setenv("CLOTHBENCH_CACHE", "", 1);
  EXPECT_TRUE(pipeline_cache_file(device_).empty());
  EXPECT_FALSE(write_pipeline_cache("/proc/nowhere/pipelines", of(device_)));
}

}  // namespace
}  // namespace clothbench::vulkan

#include <gtest/gtest.h>
#include <unistd.h>

#include <cmath>
#include <fstream>

#include "runner/environment.hpp"
#include "with_folder.hpp"

namespace clothbench {
namespace {

namespace fs = std::filesystem;

class Sensors : public WithFolder {
 protected:
  void put(const std::string& file, const std::string& text) {
    fs::create_directories((dir_ / file).parent_path());
    std::ofstream(dir_ / file) << text << "\n";
  }
};

TEST_F(Sensors, ReadsAPhonesTree) {
  put("sys/devices/system/cpu/cpu0/cpufreq/scaling_cur_freq", "1382400");
  put("sys/devices/system/cpu/cpu0/cpufreq/scaling_governor", "schedutil");
  put("sys/devices/system/cpu/cpu10/cpufreq/scaling_cur_freq", "2054400");
  put("sys/devices/system/cpu/cpu2/cpufreq/scaling_governor", "schedutil");
  put("sys/devices/system/cpu/cpuidle/current_driver", "none");
  put("sys/class/kgsl/kgsl-3d0/gpuclk", "456000000");
  put("sys/class/kgsl/kgsl-3d0/gpu_model", "Adreno740v3");
  put("sys/class/kgsl/kgsl-3d0/devfreq/governor", "msm-adreno-tz");
  put("sys/class/thermal/thermal_zone0/temp", "41300");
  put("sys/class/thermal/thermal_zone0/type", "cpu-0-0");
  put("sys/class/thermal/thermal_zone1/temp", "-274000");  // switched off
  put("sys/class/thermal/thermal_zone12/temp", "38000");
  put("sys/class/thermal/cooling_device0/type", "gpu");
  const nlohmann::json s = read_sensors(dir_);
  ASSERT_EQ(s["cpus"].size(), 3u);
  EXPECT_EQ(s["cpus"][0]["frequency_Hz"], 1382400e3);
  EXPECT_EQ(s["cpus"][1]["cpu"], 2) << "in numerical order";
  EXPECT_FALSE(s["cpus"][1].contains("frequency_Hz"));
  EXPECT_EQ(s["gpu"]["frequency_Hz"], 456e6);
  EXPECT_EQ(s["gpu"]["model"], "Adreno740v3");
  ASSERT_EQ(s["temperatures"].size(), 2u);
  EXPECT_EQ(s["temperatures"][0]["type"], "cpu-0-0");
  std::map<std::string, double> summary;
  summarise_sensors(s, "end", summary);
  EXPECT_EQ(summary.at("cpu_clock_end_Hz"), 2054400e3);
  EXPECT_EQ(summary.at("gpu_clock_end_Hz"), 456e6);
  EXPECT_NEAR(summary.at("temperature_end_C"), 41.3, 1e-9);
  EXPECT_EQ(clock_policy(s), "cpu governor schedutil, gpu governor msm-adreno-tz");
}

TEST_F(Sensors, NothingReadableIsMissingNotZero) {
  put("sys/class/thermal/thermal_zone0/temp", "");
  put("sys/class/kgsl/kgsl-3d0/gpuclk", "unknown");
  const nlohmann::json s = read_sensors(dir_);
  EXPECT_TRUE(s["cpus"].empty() && s["gpu"].empty() && s["temperatures"].empty()) << s;
  std::map<std::string, double> summary;
  summarise_sensors(s, "start", summary);
  ASSERT_EQ(summary.size(), 3u);
  for (const auto& [name, value] : summary) EXPECT_TRUE(std::isnan(value)) << name;
  EXPECT_EQ(clock_policy(s), "not readable");
}

TEST_F(Sensors, StandInEveryRunsEnvironment) {
  const nlohmann::json e = describe_environment({}, "test");
  ASSERT_TRUE(e.contains("sensors"));
  EXPECT_TRUE(e["sensors"]["cpus"].is_array() && e["sensors"]["temperatures"].is_array());
  EXPECT_FALSE(e["shader_compiler"].get<std::string>().empty());
}

}  // namespace
}  // namespace clothbench

// Number of clothbench jobs that share the machine.
#include <dlfcn.h>
#include <fcntl.h>
#include <gtest/gtest.h>
#include <sys/wait.h>
#include <unistd.h>

#include <chrono>
#include <cmath>
#include <fstream>
#include <string>
#include <thread>

#include "runner/environment.hpp"
#include "with_folder.hpp"

namespace clothbench {
namespace {

namespace fs = std::filesystem;

class Jobs : public WithFolder {
 protected:
  void process(int pid, const std::string& name, int parent, char state = 'S') {
    fs::create_directories(dir_ / std::to_string(pid));
    std::ofstream(dir_ / std::to_string(pid) / "stat")
        << pid << " (" << name << ") " << state << " " << parent << " 1 1 0";
  }
};

TEST_F(Jobs, AreProcessesOfTheProgramBesideThisOne) {
  process(1, "init", 0);
  process(10, "sh", 1);
  process(11, "clothbench", 10);
  fs::create_directories(dir_ / "self");
  fs::create_directories(dir_ / "99");  // a process that has ended meanwhile
  EXPECT_EQ(jobs_in(dir_, 11), 1);
  for (int k = 0; k < 10; ++k) process(20 + k, "clothbench", 10);
  EXPECT_EQ(jobs_in(dir_, 11), 11) << "ten more started by the same shell";
  process(20, "clothbench", 10, 'Z');
  process(21, "clothbench", 10, 'T');
  EXPECT_EQ(jobs_in(dir_, 11), 9) << "dead and stopped processes use no CPU";
  process(40, "a) S 1 (clothbench", 1);
  process(41, "clothbench-report", 1);
  EXPECT_EQ(jobs_in(dir_, 11), 9) << "other names";
}

TEST_F(Jobs, WhatStartedWhatIsOneJob) {
  process(1, "init", 0);
  process(5, "clothbench", 1);
  process(6, "clothbench", 5);
  process(7, "clothbench", 5);
  EXPECT_EQ(jobs_in(dir_, 5), 1) << "its own workers";
  EXPECT_EQ(jobs_in(dir_, 6), 2)
      << "a worker shares the machine with another, not with the process that waits for both";
  EXPECT_EQ(jobs_in(dir_ / "nothing", 6), 1);
}

/// Waits until the process has become the program, or a second has passed.
bool runs(pid_t child, const std::string& name) {
  for (int k = 0; k < 100; ++k) {
    std::string now;
    std::getline(std::ifstream("/proc/" + std::to_string(child) + "/comm"), now);
    if (now == name) return true;
    usleep(10000);
  }
  return false;
}

TEST_F(Jobs, ARealOneIsSeenAndToldNumbersCount) {
  const Variable unset("CLOTHBENCH_JOBS", nullptr);
  // A child would form one job with its parent, so it is reparented to init.
  const fs::path program = dir_ / "clothbench";
  fs::copy_file("/bin/sleep", program);
  int tell[2];
  ASSERT_EQ(pipe2(tell, O_CLOEXEC), 0);
  const int alone = jobs_now();
  const pid_t between = fork();
  if (between == 0) {
    const pid_t child = fork();
    if (child == 0) {
      execl(program.c_str(), "clothbench", "20", nullptr);
      _exit(1);
    }
    (void)!write(tell[1], &child, sizeof child);
    _exit(0);
  }
  pid_t child = 0;
  ASSERT_EQ(read(tell[0], &child, sizeof child), static_cast<ssize_t>(sizeof child));
  waitpid(between, nullptr, 0);
  ASSERT_TRUE(runs(child, "clothbench"));
  EXPECT_GE(jobs_now(), 2);
  EXPECT_GE(alone, 1);
  kill(child, SIGKILL);
  const Variable told("CLOTHBENCH_JOBS", "7");
  EXPECT_EQ(jobs_now(), 7);
}

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
  TimedTrial trial;
  store_sensors(s, trial);
  summarise_sensors(trial, "end", summary);
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
  TimedTrial trial;
  store_sensors(s, trial);
  summarise_sensors(trial, "start", summary);
  ASSERT_EQ(summary.size(), 3u);
  for (const auto& [name, value] : summary) EXPECT_TRUE(std::isnan(value)) << name;
  EXPECT_EQ(clock_policy(s), "not readable");
}

TEST_F(Sensors, PowerComesFromCountersElseFromTheBattery) {
  EXPECT_TRUE(std::isnan(PowerMeter(dir_).mean_W())) << "nothing is readable";
  const std::string battery = "sys/class/power_supply/battery/", package = "sys/class/powercap/intel-rapl:";
  put(battery + "current_now", "-1500000");
  put(battery + "voltage_now", "4000000");
  put(battery + "status", "Discharging");
  EXPECT_NEAR(PowerMeter(dir_).mean_W(), 6, 1e-9);
  put(battery + "status", "Charging");
  EXPECT_TRUE(std::isnan(PowerMeter(dir_).mean_W()));
  put(package + "0/energy_uj", "5000000");
  put(package + "1/energy_uj", "7000000");
  put(package + "0:0/energy_uj", "900");  // a part of package 0
  const auto start = std::chrono::steady_clock::now();
  const PowerMeter meter(dir_);
  std::this_thread::sleep_for(std::chrono::milliseconds(50));
  put(package + "0/energy_uj", "8000000");
  const double mean_W = meter.mean_W();
  const std::chrono::duration<double> at_most = std::chrono::steady_clock::now() - start;
  EXPECT_LE(mean_W, 3 / 0.05);
  EXPECT_GE(mean_W, 3 / at_most.count());
  put(package + "1/energy_uj", "100");  // wrapped around
  EXPECT_TRUE(std::isnan(meter.mean_W()));
}

TEST_F(Sensors, OfAnNvidiaGpuComeFromItsLibrary) {
  // A library that is loaded already is found by its name, so this stand-in replaces the driver's.
  ASSERT_NE(dlopen(CLOTHBENCH_FAKE_NVML, RTLD_NOW), nullptr) << dlerror();
  const std::string uuid = "00112233445566778899aabbccddeeff";
  const nlohmann::json s = read_sensors(dir_, uuid);
  EXPECT_EQ(s["gpu"]["power_limit_W"], 700);
  EXPECT_FALSE(s["gpu"].contains("ecc")) << "which it does not report";
  TimedTrial trial;
  store_sensors(s, trial);
  EXPECT_EQ(trial.gpu_clock_Hz, 1980e6);
  EXPECT_EQ(trial.temperature_C, 41);
  const PowerMeter meter(dir_, uuid);
  std::this_thread::sleep_for(std::chrono::milliseconds(50));
  const double mean_W = meter.mean_gpu_W();
  EXPECT_LE(mean_W, 300.1);  // the time also contains the readings
  EXPECT_GE(mean_W, 10);
  EXPECT_TRUE(std::isnan(PowerMeter(dir_, std::string(32, '0')).mean_gpu_W())) << "a GPU of another vendor";
}

TEST_F(Sensors, StandInEveryRunsEnvironment) {
  const nlohmann::json e = describe_environment({}, "test");
  ASSERT_TRUE(e.contains("sensors"));
  EXPECT_TRUE(e["sensors"]["cpus"].is_array() && e["sensors"]["temperatures"].is_array());
  EXPECT_FALSE(e["shader_compiler"].get<std::string>().empty());
}

}  // namespace
}  // namespace clothbench

#pragma once
#include <filesystem>
#include <map>
#include <nlohmann/json.hpp>
#include <string>

namespace clothbench {

/// Clocks and temperatures from Linux and Android, in Hz and degrees Celsius; values that cannot be read are left out:
///   cpus: [{cpu, frequency_Hz, min_Hz, max_Hz, governor}]   /sys/devices/system/cpu/cpuN/cpufreq
///   gpu: {model, frequency_Hz, max_Hz, governor, temperature_C}   /sys/class/kgsl/kgsl-3d0 (Adreno)
///   temperatures: [{zone, type, temperature_C}]   /sys/class/thermal
/// Units and files: Linux, Documentation/admin-guide/pm/cpufreq.rst and driver-api/thermal/sysfs-api.rst; Qualcomm's
/// kgsl driver. `root` stands for "/".
nlohmann::json read_sensors(const std::filesystem::path& root = "/");

/// Scalars of one reading: cpu_clock_<when>_Hz (of the fastest core), gpu_clock_<when>_Hz, temperature_<when>_C (of
/// the hottest zone); NaN where not readable.
void summarise_sensors(const nlohmann::json& sensors, const std::string& when, std::map<std::string, double>& summary);

/// "cpu governor schedutil, gpu governor msm-adreno-tz", or "not readable".
std::string clock_policy(const nlohmann::json& sensors);

}  // namespace clothbench

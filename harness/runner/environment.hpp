#pragma once
#include <chrono>
#include <filesystem>
#include <map>
#include <nlohmann/json.hpp>
#include <string>

#include "clothbench/record.hpp"
#include "clothbench/solver.hpp"

namespace clothbench {

/// Facts for judging a measured number: machine, compiler, commit, date, device. Stored with every run.
nlohmann::json describe_environment(const DeviceInfo& device, const std::string& protocol);

/// The features that a solver declares, for the feature table: feature names under "supports" and "ignores"; under
/// "only_with", pairs of a feature and the feature that it requires.
nlohmann::json describe_features(const SolverInfo& info);

/// Adds to an environment the solver's version and features and, for a plugin, its library: path, SHA-256 of the file,
/// summary. The hash distinguishes builds of a plugin.
void describe_solver(const SolverInfo&, nlohmann::json& environment);

/// UTC in ISO 8601, to the second.
std::string utc_now();

/// Clocks and temperatures from Linux and Android in Hz and degrees Celsius, without the values that cannot be read:
///   cpus: [{cpu, frequency_Hz, governor}]   /sys/devices/system/cpu/cpuN/cpufreq
///   gpu: {model, frequency_Hz, governor, temperature_C}   /sys/class/kgsl/kgsl-3d0 (Adreno); with `gpu_uuid` also
///     nvidia_state()
///   temperatures: [{type, temperature_C}]   /sys/class/thermal
/// Units and files: Linux, Documentation/admin-guide/pm/cpufreq.rst and driver-api/thermal/sysfs-api.rst; Qualcomm's
/// kgsl driver. `root` replaces "/".
nlohmann::json read_sensors(const std::filesystem::path& root = "/", const std::string& gpu_uuid = {});

/// UUID of the GPU in an environment, as 32 hexadecimal digits; empty for a CPU solver.
std::string uuid_of_gpu(const nlohmann::json& environment);

/// The trial's clocks and temperature: fastest core, GPU, hottest zone; NaN if not readable.
void store_sensors(const nlohmann::json& sensors, TimedTrial&);

/// Scalars cpu_clock_<when>_Hz, gpu_clock_<when>_Hz and temperature_<when>_C from these values of a trial.
void summarise_sensors(const TimedTrial&, const std::string& when, std::map<std::string, double>& summary);

/// Mean power since its construction, from the energy counters of CPU packages (RAPL,
/// /sys/class/powercap/intel-rapl:N), which usually only root may read; on battery instead the power drawn at present
/// (/sys/class/power_supply). Files and units: Linux, Documentation/power/powercap and ABI/testing/sysfs-class-power.
class PowerMeter {
 public:
  explicit PowerMeter(std::filesystem::path root = "/", std::string gpu_uuid = {});
  double mean_W() const;      ///< NaN if not readable, or if a counter wrapped around
  double mean_gpu_W() const;  ///< of an NVIDIA GPU; NaN if not readable

 private:
  double seconds() const;

  std::filesystem::path root_;
  std::string gpu_uuid_;
  std::chrono::steady_clock::time_point start_;
  double start_J_, gpu_start_J_;
};

/// "cpu governor schedutil, gpu governor msm-adreno-tz", or "not readable".
std::string clock_policy(const nlohmann::json& sensors);

/// Number of clothbench jobs on the machine at present, this process included: processes named "clothbench" that share
/// processors with this one. This process, its ancestors and its descendants are one job. At least 1, and 1 without
/// /proc. $CLOTHBENCH_JOBS overrides the number, for a scheduler that knows more than /proc shows.
int jobs_now();

/// jobs_now() with /proc at another path and without $CLOTHBENCH_JOBS.
int jobs_in(const std::filesystem::path& proc, int self);

}  // namespace clothbench

/// Facts of this build, written by build_info.cmake at every build.
namespace clothbench::build_info {
extern const char* const kCompiler;
extern const char* const kShaderCompiler;
extern const char* const kBuildType;
extern const char* const kVersion;
extern const char* const kGitCommit;
/// SHA-256 of the files that can change a result (harness/runner/measured_paths.txt); "unknown" without git.
extern const char* const kSourceSha256;
extern const bool kGitDirty;
}  // namespace clothbench::build_info

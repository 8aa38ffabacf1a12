#pragma once
#include <filesystem>
#include <map>
#include <nlohmann/json.hpp>
#include <string>

#include "clothbench/solver.hpp"

namespace clothbench {

/// Facts that a reader needs to judge a number: machine, compiler, commit, date, device. Stored with every run.
nlohmann::json describe_environment(const DeviceInfo& device, const std::string& protocol);

/// The features that a solver declares, for the feature table: names of features under "supports" and "ignores", and
/// under "only_with" pairs of a feature and another that it requires.
nlohmann::json describe_features(const SolverInfo& info);

/// Adds to an environment the solver's version and features, and of a plugin its library: path, SHA-256 of the file,
/// summary. Two builds of a plugin differ by the hash.
void describe_solver(const SolverInfo&, nlohmann::json& environment);

/// UTC, ISO 8601, seconds.
std::string utc_now();

/// Clocks and temperatures from Linux and Android, in Hz and degrees Celsius; values that cannot be read are left out:
///   cpus: [{cpu, frequency_Hz, governor}]   /sys/devices/system/cpu/cpuN/cpufreq
///   gpu: {model, frequency_Hz, governor, temperature_C}   /sys/class/kgsl/kgsl-3d0 (Adreno)
///   temperatures: [{type, temperature_C}]   /sys/class/thermal
/// Units and files: Linux, Documentation/admin-guide/pm/cpufreq.rst and driver-api/thermal/sysfs-api.rst; Qualcomm's
/// kgsl driver. `root` stands for "/".
nlohmann::json read_sensors(const std::filesystem::path& root = "/");

/// Scalars of one reading: cpu_clock_<when>_Hz (of the fastest core), gpu_clock_<when>_Hz, temperature_<when>_C (of
/// the hottest zone); NaN where not readable.
void summarise_sensors(const nlohmann::json& sensors, const std::string& when, std::map<std::string, double>& summary);

/// "cpu governor schedutil, gpu governor msm-adreno-tz", or "not readable".
std::string clock_policy(const nlohmann::json& sensors);

/// Number of clothbench jobs that the machine runs now, this process included: processes named "clothbench" that share
/// processor time with this one. This process, its ancestors and its descendants are one job. At least 1; 1 where there
/// is no /proc. $CLOTHBENCH_JOBS overrides the number, for a scheduler with information that /proc does not have.
int jobs_now();

/// jobs_now() from a /proc at another path, without $CLOTHBENCH_JOBS.
int jobs_in(const std::filesystem::path& proc, int self);

}  // namespace clothbench

/// Facts of this build, written by build_info.cmake at every build.
namespace clothbench::build_info {
extern const char* const kCompiler;
extern const char* const kShaderCompiler;
extern const char* const kBuildType;
extern const char* const kVersion;
extern const char* const kGitCommit;
/// SHA-256 of the files that may change a figure (harness/runner/measured_paths.txt); "unknown" without git.
extern const char* const kSourceSha256;
extern const bool kGitDirty;
}  // namespace clothbench::build_info

#pragma once
#include <cstdint>
#include <optional>

#include "cli/command.hpp"
#include "runner/stability_study.hpp"
#include "runner/study_runner.hpp"
#include "runner/study_runs.hpp"
#include "scenario/study.hpp"

namespace clothbench {

struct RunFlags {
  std::string out;  ///< empty: results/runs/<study>-<UTC>
  bool resume = false;
  DeviceFlags device;
  bool part = false;  ///< only some of the manifest's runs: no report of the folder at the end
};

/// Common options of commands that run solvers repeatedly: friction, threshold, moduli.
struct SearchFlags : SolverFlags {
  std::string out;  ///< empty: nothing is stored
  bool resume = false;
  void add_storage_to(CLI::App&);  ///< --out, --resume and the device options
  StudyRuns runs(const std::string& study, const Console&) const;
};

/// results/runs/<study>-<UTC>
std::filesystem::path default_folder(const std::string& study);

/// True if GPU solvers have a device; false if there is none and that is allowed. Throws Error otherwise, and if
/// --device names a missing device.
bool check_device(const SolverEntry& gpu, const DeviceFlags&);

/// For a study whose runs are in processes of their own: where and how, the manifest completed. GPU solvers are left
/// out of the study and of `only` where there is no device and that is allowed.
StabilityOptions options_apart(Study&, StudyManifest&, const RunFlags&, std::vector<std::string>& only, int jobs,
                               const Console&);

/// run_and_tell for protocol contact: `jobs` runs at a time, none of them timed.
void run_contact_and_tell(Study study, StudyManifest manifest, const RunFlags& flags, std::vector<std::string> only,
                          int jobs, Console& console);

/// run_and_tell for a study that runs in other processes (protocol stability-map), `jobs` at a time. `only`: solvers of
/// its maps.
void run_stability_and_tell(Study study, StudyManifest manifest, const RunFlags& flags, std::vector<std::string> only,
                            int jobs, Console& console);

/// Adds the option --seed, for commands whose scenes have a truth.
void add_seed(CLI::App&, std::optional<std::uint64_t>& seed);

/// The scene with parameters drawn by `seed`, printed once for each scene name; without a seed, the scene as it is.
Scene at_seed(Scene, const std::optional<std::uint64_t>& seed, Console&);

/// Writes the manifest, executes the runs with a status line and prints the results. Sets the console's exit code
/// to CheckFailed if a run broke a rule of the harness.
void run_and_tell(RunPlan plan, StudyManifest manifest, const RunFlags& flags, Console& console);

}  // namespace clothbench

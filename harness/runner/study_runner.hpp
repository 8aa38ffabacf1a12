#pragma once
#include <filesystem>
#include <functional>
#include <vector>

#include "results/store.hpp"
#include "runner/solver_run.hpp"

namespace clothbench {

/// Planned runs, in groups; the trials of one group are interleaved, so that a change of the machine's speed meets
/// all of its runs alike.
struct RunPlan {
  std::vector<std::vector<RunSpec>> groups;
  TrialRules rules;
  std::string protocol;  ///< "short", "full" or "quick", stored with every run
  /// Solvers that a study names and this build lacks: entries without `make`, whose runs become `unsupported`.
  std::vector<std::shared_ptr<const SolverEntry>> not_built;
  bool references = false;  ///< store the reference solution of each scene's truth with its runs
  bool measure_moduli =
      false;  ///< measure every solver's effective moduli at its default setting and those of its fronts

  std::size_t size() const;
};

struct RunOptions {
  std::filesystem::path out;
  bool resume = false;
  DeviceOptions device;
  /// Called before each piece of work with what it is and how many of how many pieces are done.
  std::function<void(const std::string& what, std::size_t done, std::size_t total)> progress;
  std::filesystem::path reference_cache = "results/runs/reference-cache";  ///< for plans with references
};

struct RunResult {
  std::vector<std::filesystem::path> files;
  int runs_ok = 0, runs_unsupported = 0, runs_over_budget = 0, runs_failed = 0;
  /// Wall time by solver: loads, passes, trials and files; and of "reference solutions".
  std::map<std::string, double> seconds, moduli_seconds;  ///< moduli_seconds: of effective moduli
  int moduli = 0, moduli_left_out = 0;
  int expect_passed = 0;                   ///< runs that keep what their scene expects
  std::vector<std::string> expect_failed;  ///< those that do not, and how; a result, not a fault
  int validation_messages = 0;
  std::vector<std::string> faults;  ///< runs that broke a rule of the harness (stages, validation): the run fails
};

/// Before anything is written into the folder of a study: throws Error naming the file if a run of the plan that it
/// holds, finished or begun, is of another scene, other settings or another version of its solver, or is finished and
/// not to be gone on with.
void require_same_runs(const std::filesystem::path& folder, const RunPlan&, bool resume);

/// Executes every run and writes one file each. Finished runs are skipped and finished trials reused with `resume`;
/// without it a run that is already there is an Error, and with it one of another scene, other settings or another
/// version. Throws Error with ExitCode::Interrupted on Ctrl-C.
RunResult execute_runs(const RunPlan&, const RunOptions&);

}  // namespace clothbench

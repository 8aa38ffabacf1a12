#pragma once
#include <filesystem>
#include <functional>
#include <map>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "clothbench/record.hpp"
#include "clothbench/solver.hpp"
#include "results/store.hpp"
#include "runner/solver_run.hpp"
#include "runner/worker.hpp"

namespace clothbench {

/// Planned runs, in groups. The trials of one group are interleaved, so that a change of the machine's speed affects
/// all its runs equally.
struct RunPlan {
  std::vector<std::vector<RunSpec>> groups;
  TrialRules rules;
  std::string protocol;  ///< "full" or "quick", stored with every run
  /// Solvers named by a study but missing from this build: entries without `make`, whose runs become `unsupported`.
  std::vector<std::shared_ptr<const SolverEntry>> not_built;
  bool apart = false;       ///< one untimed run of each whole scene, in worker processes, instead of trials
  bool references = false;  ///< store the reference solution of each scene's truth with its runs

  std::size_t size() const;
};

struct RunOptions {
  std::filesystem::path out;
  bool resume = false;
  int jobs = 1;                        ///< worker processes at a time, for a plan whose runs are apart
  std::filesystem::path program = {};  ///< executable of the workers; empty: this one
  DeviceOptions device;
  /// Called before each task with its description and the numbers of finished and of all tasks.
  std::function<void(const std::string& what, std::size_t done, std::size_t total)> progress;
  std::filesystem::path reference_cache = "results/runs/reference-cache";  ///< for plans with references
};

/// The rule of exit codes for every command that runs solvers: 1 if a solver finished none of its runs, whether they
/// crashed, hung, diverged, lost the device or could not be made. Runs that the solver does not support, or that were
/// left out for time, do not count; a run that ends as its scene expects does.
class SolverEnds {
 public:
  void add(const std::string& solver, const Outcome&);
  /// One sentence per solver that finished none of its runs.
  std::vector<std::string> faults() const;

 private:
  struct Ends {
    int finished = 0, failed = 0;
    std::string last;  ///< how the last one failed
  };
  std::map<std::string, Ends> ends_;
};

/// Number of runs of each stability grade.
struct Grades {
  int stable = 0, degraded = 0, failed = 0, unsupported = 0;
  int crashed = 0;  ///< runs among the failed ones whose process crashed or hung
  void add(const RunRecord&);
};

struct RunResult {
  std::vector<std::filesystem::path> files;  ///< of this session
  /// Counts over all runs of the plan, including runs that an earlier session stored.
  int runs_ok = 0, runs_unsupported = 0, runs_over_budget = 0, runs_failed = 0;
  /// Wall time by solver for loads, passes, trials and files; "reference solutions" is another entry.
  std::map<std::string, double> seconds;
  int validation_messages = 0;
  /// Runs that broke a rule of the harness (stages, counts, validation) and solvers that finished no run: exit code 1.
  std::vector<std::string> faults;
  SolverEnds ends;  ///< of all runs of the plan
  Grades grades;    ///< of a plan whose runs are apart
};

/// Call before anything is written into a study's folder. Throws Error naming the file if a stored run of the plan,
/// finished or begun, is of another scene, other settings or another solver version, or is finished and `resume` is
/// off.
void require_same_runs(const std::filesystem::path& folder, const RunPlan&, bool resume);

/// Executes every run and writes one file each. With `resume`, finished runs are skipped and finished trials reused,
/// and a run stored for another scene, other settings or another version is an Error. Without it, a run that is already
/// stored is an Error. Runs that are apart go to `jobs` workers, the longest first. Throws Error with
/// ExitCode::Interrupted on Ctrl-C.
RunResult execute_runs(const RunPlan&, const RunOptions&);

/// Whether a command gives the whole plan to one worker: its trials are timed in turns, so its solvers live together.
bool runs_in_worker(const RunPlan&);

/// As execute_runs for a timed plan, but in a worker process, where everything is timed as usual. If the process
/// crashes, or a run makes no frame for solver_limit_s(), the current run is stored as `crashed` or `timed_out` and a
/// new process continues with the rest. `eye`: size of the pictures that the plan renders, or empty.
RunResult execute_in_worker(const RunPlan&, const RunOptions&, const std::string& eye = {});

/// The worker's side; `rendering_of` makes the plan's rendering from `eye`.
nlohmann::json execute_plan(const nlohmann::json& request, const WorkerProgress&, const SolverLookup&,
                            Rendering (*rendering_of)(const std::string& eye));

/// The time budget of solvers on their ladders of settings on one scene, run in ascending order of work. Runs that are
/// not on a ladder (RunSpec::work is 0) are never refused.
class LadderBudget {
 public:
  /// Wall time of loads and untimed passes [s] of one solver; 0 = no limit.
  explicit LadderBudget(double limit_s) : limit_s_(limit_s) {}

  /// Reason why this run is skipped, or "". It is skipped if a setting of less work timed out, or if its expected time
  /// (that of the previous run, scaled by the work) exceeds its solver's remaining budget. A solver's first run is
  /// never skipped.
  std::string refused(const RunSpec&) const;
  /// Records the time of a run and how it ended.
  void spent(const RunSpec&, double seconds, const std::string& status);
  /// Time limit of a run [s], given `run_limit_s` (0 = no limit): at most the remaining budget, but at least half of
  /// the whole budget, since the time was only estimated. 0 = no limit.
  double run_limit_s(const RunSpec&, double run_limit_s) const;

 private:
  struct Climbed {
    double seconds = 0, last_s = 0;
    int last_work = 0;
    int timed_out_work = 0;  ///< 0: none
  };
  double limit_s_;
  std::map<std::string, Climbed> by_solver_;
};

/// A planned run: the data that identify it beyond its name.
struct PlannedRun {
  std::string name;             ///< as in its file names
  std::string scenario_sha256;  ///< of the completed scenario
  nlohmann::json settings;
  const SolverInfo* solver =
      nullptr;  ///< null: not known here, so settings cannot be completed nor the version compared
};

/// From a run of a plan.
PlannedRun planned_run(const RunSpec&);

/// The file of a finished run, else the folder of a run that was begun, else an empty path.
std::filesystem::path stored_run(const std::filesystem::path& folder, const std::string& run);

/// Checks that the stored data of this run, finished or begun, are of the same scene, settings and solver version.
/// Throws Error naming the file, the difference and a remedy if they are not: continuing would mix results.
void require_same_run(const std::filesystem::path& folder, const PlannedRun&);

/// The same for all runs of a study, before anything is written. Without `resume` a finished run is an Error too.
void require_same_runs(const std::filesystem::path& folder, const std::vector<PlannedRun>&, bool resume);

/// Throws "<folder>: <run> is already there; …", for a finished run without `resume`.
[[noreturn]] void refuse_finished_run(const std::filesystem::path& folder, const std::string& run);

/// A SHA-256 shortened for messages.
std::string short_hash(const std::string& sha256);

}  // namespace clothbench

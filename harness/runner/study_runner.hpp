#pragma once
#include <filesystem>
#include <functional>
#include <map>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <vector>

#include "clothbench/record.hpp"
#include "clothbench/solver.hpp"
#include "results/store.hpp"
#include "runner/solver_run.hpp"
#include "runner/worker.hpp"

namespace clothbench {

/// Planned runs, in groups. The trials of a group are interleaved, so that a change of the machine's speed affects all
/// its runs equally.
struct RunPlan {
  std::vector<std::vector<RunSpec>> groups;
  TrialRules rules;
  std::string protocol;  ///< "full" or "quick", stored with every run
  /// Solvers of the tree that this build lacks: entries without `make`, whose runs become `unsupported`.
  std::vector<std::shared_ptr<const SolverEntry>> not_built;
  bool apart = false;       ///< untimed runs of whole scenes, each in its own process
  bool untimed = false;     ///< loads and untimed passes only; the same plan with trials continues from them
  bool references = false;  ///< store each scene's reference solution with its runs

  std::size_t size() const;
  const SolverEntry* add_not_built(const std::string& solver);  ///< the new entry in `not_built`
};

struct RunOptions {
  std::filesystem::path out;
  bool resume = false;
  int jobs = 1;                        ///< concurrent worker processes for untimed work
  std::filesystem::path program = {};  ///< executable of the workers; empty: this one
  DeviceOptions device;
  /// Called before each task with its description and the numbers of finished and all tasks.
  std::function<void(const std::string& what, std::size_t done, std::size_t total)> progress;
  std::filesystem::path reference_cache = "results/runs/reference-cache";  ///< for plans with references
};

struct RunResult {
  std::vector<std::filesystem::path> files;  ///< written in this session
  std::vector<std::string> faults;           ///< violated rules of the harness: stages, counts, validation
};

/// One sentence for each solver that finished none of its runs; runs that are unsupported or skipped for time do not
/// count. If there is any sentence, `run` and `study` exit with 1. A run that ends as its scene expects is finished.
std::vector<std::string> solver_faults(const std::vector<RunRecord>&);

/// Call before anything is written into a study's folder. Throws Error if two runs of the plan have one name. Throws
/// Error with the file, the difference and a remedy if a stored run of the plan, finished or not, has a different
/// scene, settings or solver version, or is finished and `resume` is off: continuing would mix results.
void require_same_runs(const std::filesystem::path& folder, const RunPlan&, bool resume);

/// Executes every run in this process and writes one file each. With `resume`, finished runs are skipped and finished
/// trials reused; a run stored for another scene, other settings or another version is an Error. Without `resume`, a
/// finished run is an Error. Throws Error with ExitCode::Interrupted on Ctrl-C.
RunResult execute_runs(const RunPlan&, const RunOptions&);

/// Like execute_runs, but in worker processes. One process interleaves the timed trials of all runs; with `jobs` above
/// 1, untimed passes come first, on `jobs` workers. Runs that need their own process (`apart`) are distributed over the
/// workers, the longest first. If a process crashes, or a run makes no frame for too long (solver_limit_s(); if
/// `apart`, 1.2 x the run's limit + 5 s), the current run is stored as `crashed` or `timed_out` and a new process
/// continues with the rest. `eye`: image size per eye if the plan renders, otherwise empty.
RunResult execute_in_worker(const RunPlan&, const RunOptions&, const std::string& eye = {});

/// Executes one run of a plan in this worker, stores it in the folder and reads it back without positions. An exception
/// of a solver gives the outcome `error`.
RunRecord run_apart(Worker&, const RunPlan&, const RunSpec&, const RunOptions&);

/// Executes a plan in the worker; `rendering_of` makes the plan's rendering from `eye`.
nlohmann::json execute_plan(const nlohmann::json& request, const WorkerProgress&, const SolverLookup&,
                            Rendering (*rendering_of)(const std::string& eye));

/// The stored record of a finished run, without positions; empty if it is not finished. Throws Error if it is finished
/// and `resume` is off, or if it belongs to a different run.
std::optional<RunRecord> finished_run(const RunSpec&, const RunOptions&);

/// Result of checking a run against its scene's criteria: the `expect` of its file, the bounds of its exact solution
/// (ExactBound), and stability grade 0 if it has a stability block. The last two need outcome "ok". The motion check
/// applies to every run whose summary has its statistics.
struct Judgement {
  /// "pass"; "fail: " and every violated criterion with value and bound; "not measured" if a run without failure has an
  /// accuracy pass shorter than the scene, or if this build cannot measure the scene's contact; "" if the scene has no
  /// criteria and the motion was not checked.
  std::string text;
  /// "expect.<name>" -> 1 pass, 0 fail, NaN not measured; for the summary.
  std::map<std::string, double> scalars;
};

/// A value that is NaN or missing violates its criterion.
Judgement judge(const Scene&, const Outcome&, const AccuracyPass&, const std::map<std::string, double>& summary);

}  // namespace clothbench

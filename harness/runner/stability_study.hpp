#pragma once
#include <filesystem>
#include <functional>
#include <string>

#include "clothbench/solver.hpp"
#include "runner/run_process.hpp"
#include "runner/solver_ends.hpp"
#include "scenario/study.hpp"

namespace clothbench {

struct StabilityOptions {
  std::filesystem::path out;      ///< of the runs' files
  std::filesystem::path program;  ///< executable of the child processes
  DeviceOptions device;
  bool resume = false;
  int jobs = 1;  ///< concurrent processes; no run here is timed
  std::function<void(const std::string& what, std::size_t done, std::size_t total)> progress = nullptr;
};

/// 0 stable, 1 degraded, 2 failed; NaN: unsupported.
double grade_of(const RunRecord&);

/// Number of runs of each grade.
struct StabilityCounts {
  int stable = 0, degraded = 0, failed = 0, unsupported = 0;
  int crashed = 0;  ///< of the failed ones: processes that crashed or hung
  SolverEnds ends;
  void add(const RunRecord&);
};

/// Call before anything is written. Throws Error naming the file if runs in the folder are of other scenes, settings or
/// solver versions, or are finished and `resume` is off.
void require_same_runs(const Study&, const StabilityOptions&);

/// Executes every run of the study's scenes, untimed, in processes that are replaced after a fault, with one result
/// file each. With `resume`, runs that are already stored are skipped. `ended` is called for each, stored or new, one
/// call at a time.
void execute_runs_apart(const Study&, const StabilityOptions&,
                        const std::function<void(const StudySolver&, const RunRecord&)>& ended);

/// execute_runs_apart, with the grades counted.
StabilityCounts execute_stability_runs(const Study&, const StabilityOptions&);

}  // namespace clothbench

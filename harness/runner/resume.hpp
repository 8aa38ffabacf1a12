#pragma once
#include <filesystem>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "clothbench/record.hpp"
#include "clothbench/solver.hpp"
#include "runner/solver_run.hpp"

namespace clothbench {

/// A planned run, as far as its name alone does not tell it from another.
struct PlannedRun {
  std::string name;             ///< as of its files
  std::string scenario_sha256;  ///< of the completed scenario
  nlohmann::json settings;
  const SolverInfo* solver =
      nullptr;  ///< null: not known here, so settings cannot be completed and the version not compared
};

/// Of a run as a plan has it.
PlannedRun planned_run(const RunSpec&);

/// The file of a run that is finished, else the folder of one that was begun, else an empty path.
std::filesystem::path stored_run(const std::filesystem::path& folder, const std::string& run);

/// Whether what `folder` holds of this run, finished or begun, is of the same scene, settings and version of the
/// solver. Throws Error naming the file, what differs and what to do if it is not: going on would mix results.
void require_same_run(const std::filesystem::path& folder, const PlannedRun&);

/// For all runs of a study, before anything is written. Without `resume` a run that is finished is an Error too.
void require_same_runs(const std::filesystem::path& folder, const std::vector<PlannedRun>&, bool resume);

/// "<folder>: <run> is already there; …", for a run that was not asked to go on with it.
[[noreturn]] void refuse_finished_run(const std::filesystem::path& folder, const std::string& run);

/// A SHA-256 as messages show it.
std::string short_hash(const std::string& sha256);

}  // namespace clothbench

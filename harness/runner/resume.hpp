#pragma once
#include <filesystem>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "clothbench/record.hpp"
#include "clothbench/solver.hpp"
#include "runner/solver_run.hpp"

namespace clothbench {

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

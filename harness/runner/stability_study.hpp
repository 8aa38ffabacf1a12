#pragma once
#include <filesystem>
#include <functional>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "clothbench/solver.hpp"
#include "runner/run_process.hpp"
#include "scenario/study.hpp"

namespace clothbench {

struct StabilityOptions {
  std::filesystem::path out;      ///< of the runs' files, stability.json and stability-probes.jsonl
  std::filesystem::path program;  ///< what is run as a child
  DeviceOptions device;
  bool resume = false;
  int jobs = 1;                           ///< processes at a time; nothing here is timed
  nlohmann::json environment = {};        ///< stored with the maps
  std::vector<std::string> solvers = {};  ///< of the maps, if any are named
  std::function<void(const std::string& what, std::size_t done, std::size_t total)> progress = nullptr;
};

/// 0 stable, 1 degraded, 2 failed; NaN: unsupported.
double grade_of(const RunAnswer&);

/// How many runs of each kind there were, probes of the maps among them.
struct StabilityCounts {
  int stable = 0, degraded = 0, failed = 0, unsupported = 0;
  int crashed = 0;  ///< of the failed: processes that died or hung
  void add(const RunAnswer&);
  void add(const StabilityCounts&);
};

/// Before anything is written: throws Error naming the file if what the folder holds, runs or probes, is of other
/// scenes, settings or versions of solvers, or is finished and not to be gone on with.
void require_same_study(const Study&, const StabilityOptions&);

/// Every run of the study's scenes, in processes that are replaced after a fault, with a result file each; runs that
/// are there already are passed over with `resume`.
StabilityCounts execute_stability_runs(const Study&, const StabilityOptions&);

}  // namespace clothbench

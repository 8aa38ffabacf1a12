#pragma once
#include <filesystem>
#include <functional>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "clothbench/solver.hpp"
#include "runner/cell_process.hpp"
#include "scenario/study.hpp"

namespace clothbench {

struct StabilityOptions {
  std::filesystem::path out;      ///< of the cells' files, stability.json and stability-probes.jsonl
  std::filesystem::path program;  ///< what is run as a child
  DeviceOptions device;
  bool resume = false;
  int jobs = 1;                           ///< processes at a time; nothing here is timed
  nlohmann::json environment = {};        ///< stored with the maps
  std::vector<std::string> solvers = {};  ///< of the maps, if any are named
  std::function<void(const std::string& what, std::size_t done, std::size_t total)> progress = nullptr;
};

/// How many cells of each kind there were, probes of the maps among them.
struct StabilityCounts {
  int stable = 0, degraded = 0, failed = 0, unsupported = 0;
  int crashed = 0;  ///< of the failed: processes that died or hung
  void add(const CellAnswer&);
  void add(const StabilityCounts&);
};

/// Before anything is written: throws Error naming the file if what the folder holds, cells or probes, is of other
/// scenes, settings or versions of solvers, or is finished and not to be gone on with.
void require_same_study(const Study&, const StabilityOptions&);

/// Every cell of the study's scenes, in processes that are replaced after a fault, with a result file each; cells that
/// are there already are passed over with `resume`.
StabilityCounts run_stability_cells(const Study&, const StabilityOptions&);

/// The study's maps: for every row (y) and solver the values of x in order, then the boundary by bisection, for every
/// seed. Each probe is a cell in such a process; its answer is appended to stability-probes.jsonl, and read back
/// from there instead of run again with `resume`. Writes stability.json after every row:
///   {maps: [{name, title, scene, good, headline, x: {label, unit}, y: {label, unit},
///            theory: [{name, label, points: [[x, y]]}],
///            solvers: [{solver, setting, on_gpu, unsupported, probes: [{x, y, seed, status, class, grade, frame,
///            message}],
///                       rows: [{y, seeds: [{last_good, first_bad}]}], largest, open}]}]}
/// `largest` is the least over rows and seeds of `last_good`; `open` that no row turned at all; first_bad null = none
/// is bad.
StabilityCounts run_stability_maps(const Study&, const StabilityOptions&);

}  // namespace clothbench

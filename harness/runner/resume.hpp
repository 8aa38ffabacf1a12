#pragma once
#include <filesystem>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "clothbench/record.hpp"
#include "clothbench/solver.hpp"
#include "runner/cell.hpp"

namespace clothbench {

/// A cell that is to be run, as far as its name alone does not tell it from another.
struct PlannedCell {
  std::string name;             ///< as of its files
  std::string scenario_sha256;  ///< of the completed scenario
  nlohmann::json settings;
  const SolverInfo* solver =
      nullptr;  ///< null: not known here, so settings cannot be completed and the version not compared
};

/// Of a cell as a plan has it.
PlannedCell planned_cell(const CellSpec&);

/// The file of a cell that is finished, else the folder of one that was begun, else an empty path.
std::filesystem::path stored_cell(const std::filesystem::path& folder, const std::string& cell);

/// Whether what `folder` holds of this cell, finished or begun, is of the same scene, settings and version of the
/// solver. Throws Error naming the file, what differs and what to do if it is not: going on would mix results.
void require_same_cell(const std::filesystem::path& folder, const PlannedCell&);

/// For all cells of a run, before anything is written. Without `resume` a cell that is finished is an Error too.
void require_same_cells(const std::filesystem::path& folder, const std::vector<PlannedCell>&, bool resume);

/// "<folder>: <cell> is already there; …", for a run that was not asked to go on with it.
[[noreturn]] void refuse_finished_cell(const std::filesystem::path& folder, const std::string& cell);

/// A SHA-256 as messages show it.
std::string short_hash(const std::string& sha256);

}  // namespace clothbench

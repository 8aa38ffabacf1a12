#pragma once
#include <filesystem>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "base/table.hpp"
#include "clothbench/record.hpp"

namespace clothbench {

/// Whether a run's scene is judged frame by frame (has a "stability" block).
bool is_stability(const RunRecord&);

/// The maps of study folders, in order: what stands in their stability.json; see runner/stability_study.hpp. Throws
/// Error naming a file that is none.
nlohmann::json stability_maps(const std::vector<std::filesystem::path>& results);

/// Solver x case: how many runs of the case were stable, degraded and failed, with the classes of those that were not.
Table robustness_table(const std::vector<RunRecord>& runs);

/// How many runs of each case and solver were stable, degraded and failed: [{"case", "solver", "stable", ...}].
nlohmann::json stability_cases(const std::vector<RunRecord>& runs);

/// One number a map and solver, and the boundary of every row.
Table headline_table(const nlohmann::json& maps);
Table boundary_table(const nlohmann::json& maps);

/// Failed and degraded runs by solver and class, each with its first such frame.
Table first_failure_table(const std::vector<RunRecord>& runs);

/// One row a run: case, scene, solver, setting, status, grade, class, frame, message and the extremes that were judged.
std::string stability_csv(const std::vector<RunRecord>& runs);

}  // namespace clothbench

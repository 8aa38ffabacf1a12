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

/// The stability maps of study folders, in order, from their stability.json (runner/stability_study.hpp). Throws Error
/// naming a file that is not a stability map.
nlohmann::json stability_maps(const std::vector<std::filesystem::path>& results);

/// Solver x case: number of stable, degraded and failed runs, with the failure classes.
Table robustness_table(const std::vector<RunRecord>& runs);

/// Number of stable, degraded and failed runs of each case and solver: [{"case", "solver", "stable", ...}].
nlohmann::json stability_cases(const std::vector<RunRecord>& runs);

/// headline_table: one number per map and solver. boundary_table: the stability boundary of every row of the maps.
Table headline_table(const nlohmann::json& maps);
Table boundary_table(const nlohmann::json& maps);

/// Failed and degraded runs by solver and class, each with its first failed or degraded frame.
Table first_failure_table(const std::vector<RunRecord>& runs);

/// One row a run: case, scene, solver, setting, status, grade, class, frame, message and the judged extremes.
std::string stability_csv(const std::vector<RunRecord>& runs);

}  // namespace clothbench

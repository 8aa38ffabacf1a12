#pragma once
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "base/table.hpp"
#include "clothbench/record.hpp"
#include "metrics/friction_forms.hpp"
#include "truth/reference_case.hpp"

namespace clothbench {

/// Whether a run is a run of `clothbench threshold` or `clothbench friction`.
bool is_friction(const RunRecord&);

/// What a search found, from the runs that it asked for.
struct ThresholdRow {
  std::string scene, solver, setting;
  truth::Threshold of;
  FoundThreshold found;
  std::string crash;        ///< what became of a plugin's process instead; empty else
  bool unfinished = false;  ///< a run that the search asks for is not there
};

/// By scene, solver and setting, in the order of first appearance.
std::vector<ThresholdRow> threshold_rows(const std::vector<RunRecord>&);

/// {scene, solver, exact, found, error, error_name, error_units, bound, failed, runs}, or {scene, solver, crashed}.
nlohmann::json threshold_json(const ThresholdRow&);
/// One line.
std::string threshold_sentence(const ThresholdRow&);

/// Solvers at their settings against the closed forms (metrics/friction_forms.hpp). An error is in the form's unit,
/// signed for thresholds, null where it is unsupported, failed, crashed or not there.
Table friction_table(const std::vector<RunRecord>&);
/// [{solver, setting, answers: [{scene, what, error, at_most, text}]}]
nlohmann::json friction_json(const std::vector<RunRecord>&);

/// Of what a folder has: friction_table, and a table of the searches.
std::vector<Table> friction_tables(const std::vector<RunRecord>&);

/// Runs of plugins whose process crashed, a line each.
std::vector<std::string> friction_crashes(const std::vector<RunRecord>&);

}  // namespace clothbench

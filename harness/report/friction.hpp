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

/// The friction threshold that a search found from its runs.
struct ThresholdRow {
  std::string scene, solver, setting;
  truth::Threshold of;
  FoundThreshold found;
  std::string crash;        ///< how a plugin's process crashed; empty if it did not
  std::string unsupported;  ///< why the solver cannot run the scene; empty if it can
  bool unfinished = false;  ///< a run that the search needs is missing
};

/// By scene, solver and setting, in the order of first appearance.
std::vector<ThresholdRow> threshold_rows(const std::vector<RunRecord>&);

/// {scene, solver, exact, found, error, error_name, error_units, bound, failed, runs}, {scene, solver, crashed} or
/// {scene, solver, unsupported}.
nlohmann::json threshold_json(const ThresholdRow&);
/// One line.
std::string threshold_sentence(const ThresholdRow&);

/// Errors of solvers, for each setting, against the closed forms (metrics/friction_forms.hpp). An error has the form's
/// unit and is signed for thresholds. It is null if the run is unsupported, failed, crashed or missing.
Table friction_table(const std::vector<RunRecord>&);
/// [{solver, setting, answers: [{scene, what, error, at_most, text}]}]
nlohmann::json friction_json(const std::vector<RunRecord>&);

/// friction_table and a table of the searches, as far as `runs` has data for them.
std::vector<Table> friction_tables(const std::vector<RunRecord>&);

/// One line for each run of a plugin whose process crashed.
std::vector<std::string> friction_crashes(const std::vector<RunRecord>&);

}  // namespace clothbench

#pragma once
#include <nlohmann/json.hpp>
#include <string>
#include <utility>
#include <vector>

#include "base/table.hpp"
#include "clothbench/record.hpp"
#include "clothbench/solver.hpp"

namespace clothbench {

/// What one solver can do: declared, and shown by results.
struct SolverFeatures {
  std::string solver;
  bool known = false;  ///< it was in the build; if not, nothing is known of it
  FeatureSet supports = {}, ignores = {};
  std::vector<std::pair<Feature, Feature>> only_with = {};
  FeatureSet shown = {};  ///< served by a stage of a run that ended well
};

/// Of every solver among the runs, from what their files store; in the order of first appearance.
std::vector<SolverFeatures> solver_features(const std::vector<RunRecord>& runs);

/// As declared by a solver of this build; nothing is shown.
SolverFeatures declared_features(const SolverInfo&);

/// "yes", "no", "only with duplicated layer", "ignored", "not built"; "declared" for a yes that no run shows, where
/// `with_results`.
std::string feature_text(const SolverFeatures&, Feature, bool with_results);

/// Table 4: rows are features, columns solvers.
Table feature_table(const std::vector<SolverFeatures>&, bool with_results);

nlohmann::json feature_json(const std::vector<SolverFeatures>&, bool with_results);

}  // namespace clothbench

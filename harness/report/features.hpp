#pragma once
#include <nlohmann/json.hpp>
#include <string>
#include <utility>
#include <vector>

#include "base/table.hpp"
#include "clothbench/record.hpp"
#include "clothbench/solver.hpp"

namespace clothbench {

/// Features of one solver: declared ones, and those that results confirm.
struct SolverFeatures {
  std::string solver;
  bool known = false;  ///< the solver was in the build; if not, its features are unknown
  FeatureSet supports = {}, ignores = {};
  std::vector<std::pair<Feature, Feature>> only_with = {};
  FeatureSet shown = {};  ///< served by a stage of a run that ended well
};

/// Features of every solver among the runs, as their files store them; in the order of first appearance.
std::vector<SolverFeatures> solver_features(const std::vector<RunRecord>& runs);

/// Declared features of a solver of this build; `shown` is empty.
SolverFeatures declared_features(const SolverInfo&);

/// "yes", "no", "only with duplicated layer", "ignored" or "not built". With `with_results`, "declared" replaces a
/// "yes" that no run confirms.
std::string feature_text(const SolverFeatures&, Feature, bool with_results);

/// Table 4: rows are features, columns solvers.
Table feature_table(const std::vector<SolverFeatures>&, bool with_results);

nlohmann::json feature_json(const std::vector<SolverFeatures>&, bool with_results);

}  // namespace clothbench

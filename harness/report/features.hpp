#pragma once
#include <nlohmann/json.hpp>
#include <string>
#include <utility>
#include <vector>

#include "base/table.hpp"
#include "clothbench/record.hpp"
#include "clothbench/solver.hpp"

namespace clothbench {

/// Features that one solver declares.
struct SolverFeatures {
  std::string solver;
  bool known = false;  ///< the solver was in the build; if not, its features are unknown
  FeatureSet supports = {}, ignores = {};
  std::vector<std::pair<Feature, Feature>> only_with = {};
};

/// Features of every solver among the runs, as their files store them; in the order of first appearance.
std::vector<SolverFeatures> solver_features(const std::vector<RunRecord>& runs);

/// Features of a solver of this build.
SolverFeatures declared_features(const SolverInfo&);

/// "yes", "no", "yes (only with duplicated layer)", "ignored" or "not built".
std::string feature_text(const SolverFeatures&, Feature);

/// Table 4: rows are features, columns solvers.
Table feature_table(const std::vector<SolverFeatures>&);

nlohmann::json feature_json(const std::vector<SolverFeatures>&);

}  // namespace clothbench

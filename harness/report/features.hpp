#pragma once
#include <nlohmann/json.hpp>
#include <string>
#include <utility>
#include <vector>

#include "base/table.hpp"
#include "clothbench/record.hpp"

namespace clothbench {

/// Names of solvers, each with its features as describe_features() states them; null if the build lacks the solver.
using DeclaredFeatures = std::vector<std::pair<std::string, nlohmann::json>>;

/// The features that every solver among the runs declares in its files, in the order of first appearance.
DeclaredFeatures declared_features(const std::vector<RunRecord>& runs);

/// Table 4: rows are features, columns solvers. Cells: "yes", "no", "yes (only with duplicated layer)", "ignored" or
/// "not built".
Table feature_table(const DeclaredFeatures&);

nlohmann::json feature_json(const DeclaredFeatures&);

}  // namespace clothbench

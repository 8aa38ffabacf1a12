#pragma once
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "report/pairs.hpp"

namespace clothbench {

/// True for a run whose scene has irrelevant features switched on.
bool is_all_on(const RunRecord&);

/// The cost of features that a scene does not use: pairs "irrelevant" (pairs.hpp), by scene. The other run has such
/// features switched on (harness/scenario/irrelevant.hpp). The value is unknown if one did not end well. `runs` must
/// outlive the result.
std::vector<RunPair> feature_costs(const std::vector<RunRecord>& runs);

/// Rows: scene x solver. Columns: times of both, their ratio, dispatches, bytes, memory, change of positions.
Table feature_cost_table(const std::vector<RunPair>&);
/// Which solvers keep the no-op rule. Rows: solvers. Columns: number of scenes that keep it, worst scene.
Table no_op_table(const std::vector<RunPair>&);
nlohmann::json feature_cost_json(const std::vector<RunPair>&);
std::string feature_cost_csv(const std::vector<RunPair>&);

}  // namespace clothbench

#pragma once
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "base/table.hpp"
#include "clothbench/record.hpp"

namespace clothbench {

/// Greatest allowed change of positions, over the cloth's longer side, when an irrelevant feature is switched on.
inline constexpr double kNoOp = 1e-6;

/// The cost of features that a scene does not use: a run of the scene as it is, and one with such features switched on
/// (harness/scenario/irrelevant.hpp).
struct FeatureCost {
  const RunRecord* needed = nullptr;
  const RunRecord* all = nullptr;
  std::vector<std::string> added;  ///< features
  double moved = kMissing;         ///< greatest distance of a vertex between the runs, over the longer side
  bool no_op() const { return moved <= kNoOp; }  ///< false where not measured
};

/// True for a run whose scene has irrelevant features switched on.
bool is_all_on(const RunRecord&);

/// Pairs every run that has irrelevant features with the run of the same scene, solver and setting in the same folder.
/// Runs without a partner are left out. Reads trajectories. `runs` must outlive the result.
std::vector<FeatureCost> feature_costs(const std::vector<RunRecord>& runs);

/// Rows: scene x solver. Columns: times of both, their ratio, dispatches, bytes, memory, change of positions.
Table feature_cost_table(const std::vector<FeatureCost>&);
/// Which solvers keep the no-op rule. Rows: solvers. Columns: number of scenes that keep it, worst scene.
Table no_op_table(const std::vector<FeatureCost>&);
nlohmann::json feature_cost_json(const std::vector<FeatureCost>&);
std::string feature_cost_csv(const std::vector<FeatureCost>&);

}  // namespace clothbench

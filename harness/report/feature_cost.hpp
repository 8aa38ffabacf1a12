#pragma once
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "base/table.hpp"
#include "clothbench/record.hpp"

namespace clothbench {

/// Positions may move by this much of the cloth's longer side when something irrelevant is switched on.
inline constexpr double kNoOp = 1e-6;

/// A scene as it is, and the same with features switched on that it does not use (harness/scenario/irrelevant.hpp): the
/// cost of those features.
struct FeatureCost {
  const RunRecord* needed = nullptr;
  const RunRecord* all = nullptr;
  std::vector<std::string> added;  ///< features
  double moved = kMissing;  ///< greatest distance of a vertex in one from the other, over the cloth's longer side
  bool no_op() const { return moved <= kNoOp; }  ///< false where not measured
};

/// True for a run with something irrelevant in its scene.
bool is_all_on(const RunRecord&);

/// Every run with something irrelevant, with its partner in the same folder: same scene, solver and setting. Those
/// without a partner are left out. Reads trajectories. `runs` must outlive the answer.
std::vector<FeatureCost> feature_costs(const std::vector<RunRecord>& runs);

/// Rows: scene x solver: times of both, their ratio, dispatches, bytes, memory, how far the cloth moved.
Table feature_cost_table(const std::vector<FeatureCost>&);
/// Which solvers keep the no-op rule: rows solvers, in how many of their scenes nothing moved, worst scene.
Table no_op_table(const std::vector<FeatureCost>&);
nlohmann::json feature_cost_json(const std::vector<FeatureCost>&);
std::string feature_cost_csv(const std::vector<FeatureCost>&);

}  // namespace clothbench

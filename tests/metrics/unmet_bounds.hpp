#pragma once
#include <gtest/gtest.h>

#include <set>
#include <string>

#include "../scenario/scratch_folder.hpp"
#include "metrics/registry.hpp"
#include "prescribed_solver.hpp"
#include "results/store.hpp"
#include "runner/study_runner.hpp"

namespace clothbench {

/// The stored record of a run without timed trials; of the whole scene, or of its first seconds.
inline RunRecord stored_run(const Scene& scene, const SolverEntry& entry, double accuracy_s = 0) {
  const ScratchFolder folder;
  RunPlan plan;
  plan.groups = {{{&scene, &entry, nlohmann::json::object()}}};
  plan.rules.trials = 0;
  plan.rules.accuracy_duration_s = accuracy_s > 0 ? accuracy_s : scene.time.duration_s;
  plan.protocol = "test";
  RunOptions options;
  options.out = folder.path();
  RunRecord record = read_run(execute_runs(plan, options).files.at(0));
  EXPECT_EQ(solver_faults({record}).empty(), record.outcome.status == "ok");
  return record;
}

inline const std::vector<double>& series(const RunRecord& r, const std::string& name) {
  for (const MetricSeries& m : r.accuracy.metrics)
    if (m.name == name) return m.values;
  throw std::runtime_error("no metric " + name);
}

/// Names in the scene's `expect` whose bounds the stored run of a prescribed motion violates. NaN violates every bound.
inline std::set<std::string> unmet_bounds(const Scene& scene, const SolverEntry& motion) {
  std::set<std::string> out;
  for (const auto& [name, met] : stored_run(scene, motion).summary)
    if (name.starts_with(kExpect) && !(met == 1)) out.insert(name.substr(kExpect.size()));
  return out;
}

}  // namespace clothbench

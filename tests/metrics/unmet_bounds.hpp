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

/// Names in the scene's `expect` that the stored run of a prescribed motion does not meet. NaN meets nothing.
inline std::set<std::string> unmet_bounds(const Scene& scene, const SolverEntry& motion) {
  const ScratchFolder folder;
  RunPlan plan;
  plan.groups = {{{&scene, &motion, nlohmann::json::object()}}};
  plan.rules.trials = 0;
  plan.rules.accuracy_duration_s = scene.time.duration_s;
  plan.protocol = "test";
  RunOptions options;
  options.out = folder.path();
  const RunRecord run = read_run(execute_runs(plan, options).files.at(0));
  std::set<std::string> out;
  for (const auto& [name, met] : run.summary)
    if (name.starts_with(kExpect) && !(met == 1)) out.insert(name.substr(kExpect.size()));
  return out;
}

}  // namespace clothbench

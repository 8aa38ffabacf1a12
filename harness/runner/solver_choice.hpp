#pragma once
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "clothbench/solver.hpp"
#include "runner/study_runner.hpp"
#include "scenario/study.hpp"

namespace clothbench {

/// Arguments of `--set`: `solver.<name>=<JSON>` go to the solver, everything else to the scene.
struct Overrides {
  std::vector<std::string> scene;
  nlohmann::json solver = nlohmann::json::object();
  std::string label() const;  ///< short name of the solver part, "default" if empty
};
/// Throws Error naming the argument that has no "=".
Overrides split_overrides(const std::vector<std::string>& set);
/// For commands whose scenes are fixed: throws Error with `expected` if an override is not of the solver.
void refuse_scene(const std::vector<std::string>& set, const std::string& expected);

/// A solver with complete settings and their short name.
struct ChosenSolver {
  const SolverEntry* entry;
  nlohmann::json settings;
  std::string setting;
};
/// Throws Error naming the nearest known solver or setting.
ChosenSolver chosen_solver(const std::string& name, const Overrides&);

/// Solvers of the build, and the plugins that --solver or the environment name. Throws Error for a library that is
/// none.
std::vector<const SolverEntry*> all_solvers();

/// Names of all solvers of the build, or of those that `are` accepts.
std::vector<std::string> solver_names(bool (*are)(const SolverInfo&) = nullptr);

/// The device of a command, and whether GPU solvers may be left out where there is none.
struct DeviceChoice {
  DeviceOptions options;
  bool allow_no_device = false;
};

/// Before anything is measured: drops GPU solvers from the plan, with a notice on stderr, where there is no device and
/// that is allowed. Throws Error if it is not, and if the chosen device is missing.
void settle_device(RunPlan&, const DeviceChoice&);

}  // namespace clothbench

#pragma once
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "clothbench/solver.hpp"
#include "runner/study_runner.hpp"
#include "scenario/study.hpp"

namespace clothbench {

/// "full" or "quick", as stored with runs.
const char* protocol_name(StudyLength);

/// Null if this process does not have it: neither built in nor in a loaded plugin.
const SolverEntry* known_solver(const std::string& name);

/// The settings by which plugins among these solvers climb a study's ladder: substeps, iterations, as far as they have
/// them.
std::map<std::string, std::vector<std::string>> knobs_of_plugins(const std::vector<std::string>& solvers);

/// A study's runs. The study must outlive the plan. Solvers named by the study but missing from this build become
/// `unsupported` runs. Throws Error for any other unknown solver, and for an unknown setting.
RunPlan plan_study(const Study&, const std::function<const SolverEntry*(const std::string&)>& lookup = known_solver);

/// Names of all runs of the plan, in the order that numbers them from 0.
std::vector<std::string> run_names(const RunPlan&);

/// Parses "7", "3-5" (inclusive) or a list of these, "0,3-5,9", to ascending numbers. Throws Error for any other text
/// and for numbers that are not below `count`.
std::vector<std::size_t> parse_runs(const std::string& text, std::size_t count);

/// The plan with only these runs, their groups kept.
RunPlan only_runs(RunPlan, const std::vector<std::size_t>& runs);

/// Arguments of `--set`: `solver.<name>=<JSON>` go to the solver, everything else to the scene.
struct Overrides {
  std::vector<std::string> scene;
  nlohmann::json solver = nlohmann::json::object();
  std::string label() const;  ///< short name of the solver part, "default" if empty
};
/// Throws Error naming the argument that has no "=".
Overrides split_overrides(const std::vector<std::string>& set);

/// A solver with complete settings and their short name.
struct ChosenSolver {
  const SolverEntry* entry;
  nlohmann::json settings;
  std::string setting;
};
/// Throws Error naming the nearest known solver or setting.
ChosenSolver chosen_solver(const std::string& name, const Overrides&);

/// Solvers of the build, and the plugins that --solver or the environment name. Throws Error for a library that is
/// no plugin.
std::vector<const SolverEntry*> all_solvers();

/// Names of all solvers of the build, or of those that `are` accepts.
std::vector<std::string> solver_names(bool (*are)(const SolverInfo&) = nullptr);

/// Before anything is measured: throws Error if the plan has GPU solvers and there is no device, or not the chosen one.
void require_device(const RunPlan&, const DeviceOptions&);

}  // namespace clothbench

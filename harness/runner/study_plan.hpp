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

/// The entry of a built-in solver or a loaded plugin of this process; otherwise null.
const SolverEntry* known_solver(const std::string& name);

/// For each plugin among these solvers, the settings that a study's sweep varies: substeps and iterations, if it has
/// them.
std::map<std::string, std::vector<std::string>> knobs_of_plugins(const std::vector<std::string>& solvers);

/// The runs of a study, which must outlive the plan. Solvers that are in the tree but not in this build give
/// `unsupported` runs. Throws Error for any other unknown solver and for an unknown setting.
RunPlan plan_study(const Study&, const std::function<const SolverEntry*(const std::string&)>& lookup = known_solver);

/// Makes the trials of every run windows of up to 10 s that follow each other for `duration_s`, at the scene's frame
/// rate, and the runs follow each other: shows how clocks and frame times change as a device gets warm.
void sustain(RunPlan&, double duration_s);

/// Names of all runs of the plan; a run's number is its index here, from 0.
std::vector<std::string> run_names(const RunPlan&);

/// Parses names of runs, "7", "3-5" (inclusive) or a list of these, "0,3-5,9", to ascending numbers. Throws Error for
/// any other text and for numbers without a name.
std::vector<std::size_t> parse_runs(const std::string& text, const std::vector<std::string>& names);

/// The plan reduced to these runs, with their groups unchanged.
RunPlan only_runs(RunPlan, const std::vector<std::size_t>& runs);

/// Arguments of `--set`: `solver.<name>=<JSON>` changes a setting of the solver; any other key changes the scene.
struct Overrides {
  std::vector<std::string> scene;
  nlohmann::json solver = nlohmann::json::object();
  std::string label() const;  ///< short name of the solver part, "default" if empty
};
/// Throws Error that names an argument without "=".
Overrides split_overrides(const std::vector<std::string>& set);

/// A solver with complete settings and a short name for them.
struct ChosenSolver {
  const SolverEntry* entry;
  nlohmann::json settings;
  std::string setting;
};
/// Throws Error that suggests the most similar known solver or setting.
ChosenSolver chosen_solver(const std::string& name, const Overrides&);

/// Solvers of the build, and plugins from --solver or the environment. Throws Error for a library that is not a plugin.
std::vector<const SolverEntry*> all_solvers();

/// Names of all solvers of the build, or of those for which `are` is true.
std::vector<std::string> solver_names(bool (*are)(const SolverInfo&) = nullptr);

/// Call before measuring: throws Error if the plan has GPU solvers and there is no device, or not the requested one.
void require_device(const RunPlan&, const DeviceOptions&);

}  // namespace clothbench

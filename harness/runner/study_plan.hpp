#pragma once
#include <string>

#include "runner/study_runner.hpp"
#include "scenario/study.hpp"

namespace clothbench {

/// "short", "full" or "quick", as stored with runs.
const char* protocol_name(StudyLength);

/// Null if this process does not have it: neither built in nor in a loaded plugin.
const SolverEntry* known_solver(const std::string& name);

/// The settings by which plugins among these solvers climb a study's ladder: substeps, iterations, as far as they have
/// them.
std::map<std::string, std::vector<std::string>> knobs_of_plugins(const std::vector<std::string>& solvers);

/// A study's runs. The study must outlive the plan. Solvers named by the study but missing from this build become
/// `unsupported` runs. Throws Error for a solver that neither names, and for an unknown setting.
RunPlan plan_study(const Study&, const std::function<const SolverEntry*(const std::string&)>& lookup = known_solver);

}  // namespace clothbench

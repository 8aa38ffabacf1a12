#pragma once
#include <string>

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
/// `unsupported` runs. Throws Error for a solver that neither names, and for an unknown setting.
RunPlan plan_study(const Study&, const std::function<const SolverEntry*(const std::string&)>& lookup = known_solver);

/// Names of all runs of the plan, in the order that numbers them from 0.
std::vector<std::string> run_names(const RunPlan&);

/// Parses "7", "3-5" (inclusive) or a list of these, "0,3-5,9", to ascending numbers. Throws Error for any other text
/// and for numbers that are not below `count`.
std::vector<std::size_t> parse_runs(const std::string& text, std::size_t count);

/// The plan with only these runs, their groups kept.
RunPlan only_runs(RunPlan, const std::vector<std::size_t>& runs);

}  // namespace clothbench

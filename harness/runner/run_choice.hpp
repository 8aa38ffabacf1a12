#pragma once
#include <string>
#include <vector>

#include "runner/study_runner.hpp"

namespace clothbench {

/// Names of all runs of the plan, in the order that numbers them from 0.
std::vector<std::string> run_names(const RunPlan&);

/// "7", "3-5" (both ends belong to it) or a list of these, "0,3-5,9" -> ascending numbers. Throws Error on anything
/// else and on numbers that are not below `count`.
std::vector<std::size_t> parse_runs(const std::string& text, std::size_t count);

/// The plan with these runs alone, their groups kept.
RunPlan only_runs(RunPlan, const std::vector<std::size_t>& runs);

}  // namespace clothbench

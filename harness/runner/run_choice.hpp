#pragma once
#include <string>
#include <vector>

#include "runner/study_runner.hpp"

namespace clothbench {

/// Names of all runs of the plan, in the order that numbers them from 0.
std::vector<std::string> run_names(const RunPlan&);

/// Parses "7", "3-5" (inclusive) or a list of these, "0,3-5,9", to ascending numbers. Throws Error for any other text
/// and for numbers that are not below `count`.
std::vector<std::size_t> parse_runs(const std::string& text, std::size_t count);

/// The plan with only these runs, their groups kept.
RunPlan only_runs(RunPlan, const std::vector<std::size_t>& runs);

}  // namespace clothbench

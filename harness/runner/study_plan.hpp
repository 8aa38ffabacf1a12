#pragma once
#include <string>

#include "runner/study_runner.hpp"
#include "scenario/study.hpp"

namespace clothbench {

/// "short", "full" or "quick", as runs store it.
const char* protocol_name(StudyLength);

/// Null if this process does not know it: not built, and no plugin that was loaded.
const SolverEntry* known_solver(const std::string& name);

/// A study's runs. The study must outlive the plan. Solvers that the study names and this build does not have become
/// `unsupported` runs; throws Error for one that neither names, and for an unknown setting.
RunPlan plan_study(const Study&);

}  // namespace clothbench

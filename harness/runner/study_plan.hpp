#pragma once
#include <string>

#include "runner/study_runner.hpp"
#include "scenario/study.hpp"

namespace clothbench {

/// "short", "full" or "quick", as cells store it.
const char* protocol_name(StudyLength);

/// Null if this process does not know it: not built, and no plugin that was loaded.
const SolverEntry* known_solver(const std::string& name);

/// A study's cells. The study must outlive the plan. Solvers that the study names and this build does not have become
/// `unsupported` cells; throws Error for one that neither names, and for an unknown setting.
CellPlan plan_study(const Study&);

}  // namespace clothbench

#pragma once
#include "runner/study_runner.hpp"
#include "scenario/study.hpp"

namespace clothbench {

/// A study's cells with the short or the full protocol, of the solvers in `only` (the study's if empty; one
/// that it does not name has its default settings). The study must outlive the plan. Throws Error for a solver or setting this build does not have.
CellPlan plan_study(const Study&, bool full, const std::vector<std::string>& only);

}  // namespace clothbench

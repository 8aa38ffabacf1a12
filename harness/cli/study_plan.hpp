#pragma once
#include "runner/study_runner.hpp"
#include "scenario/study.hpp"

namespace clothbench {

/// A study's cells. The study must outlive the plan. Solvers that the study names and this build does not have become
/// `unsupported` cells; throws Error for one that neither names, and for an unknown setting.
CellPlan plan_study(const Study&);

}  // namespace clothbench

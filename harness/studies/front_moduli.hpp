#pragma once
#include "runner/study_runner.hpp"

namespace clothbench {

/// Measures the effective moduli of the plan's solvers, stored in its folder as runs of the scene "effective-moduli": a
/// full measurement at each solver's default setting, and short ones at the settings on its Pareto fronts of error
/// against time, taken from the finished runs. A full study measures all of them. A shorter one measures only settings
/// that can change a verdict: on scenes whose exact solution depends on a stiffness that the default setting has as a
/// parameter. The baseline `reference` is the model itself and is not ranked; only a full study measures it, at the
/// default setting. Finished measurements are kept. Adds the new runs to the manifest, and stores the time taken and
/// the number left out in the result.
void add_moduli_runs(const RunPlan&, const RunOptions&, StudyManifest&, RunResult&);

}  // namespace clothbench

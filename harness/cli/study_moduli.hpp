#pragma once
#include "runner/study_runner.hpp"

namespace clothbench {

/// Adds the effective moduli of the plan's solvers to its folder, as runs of the scene "effective-moduli": a full one
/// at each solver's default setting, and short ones at settings on its fronts of error against time, which the runs
/// already there tell. A full study measures all of them; a shorter one those that can still change a verdict: on
/// scenes whose answer depends on a stiffness that the default measured does not deny. The baseline `reference`, which
/// is the model and is not ranked, has a measurement in a full study alone, its default one. Finished moduli are left
/// as they are; the manifest is written anew with what was added, and what it took and what was left out stands in the
/// result.
void add_moduli_runs(const RunPlan&, const RunOptions&, StudyManifest&, RunResult&);

}  // namespace clothbench

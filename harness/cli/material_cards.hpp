#pragma once
#include "runner/study_runner.hpp"

namespace clothbench {

/// Adds the material cards of the plan's solvers to its folder, as cells of the scene "material-card": a full one at
/// each solver's default setting, and short ones at settings on its fronts of error against time, which the cells
/// already there tell. A full study measures all of them; a shorter one those that can still change a verdict: on
/// scenes whose answer depends on a stiffness that the default card does not deny. The yardstick `reference`, which is
/// the model and is not ranked, has a card in a full study alone, its default one. Finished cards are left as they are;
/// the manifest is written anew with what was added, and what it took and what was left out stands in the result.
void add_material_cards(const CellPlan&, const RunOptions&, StudyManifest&, RunResult&);

}  // namespace clothbench

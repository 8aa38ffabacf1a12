#pragma once
#include "runner/study_runner.hpp"

namespace clothbench {

/// Adds the material cards of the plan's solvers to its folder, as cells of the scene "material-card": a full one at
/// each solver's default setting, and a short one at every setting on one of its fronts of error against time, which
/// the cells already there tell. The reference, which races nobody, has the full one alone. Finished cards are left as
/// they are. The manifest is written anew with what was added.
void add_material_cards(const CellPlan&, const RunOptions&, StudyManifest&);

}  // namespace clothbench

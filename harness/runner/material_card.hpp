#pragma once
#include <filesystem>
#include <map>
#include <string>

#include "clothbench/record.hpp"
#include "clothbench/solver.hpp"
#include "runner/study_runs.hpp"

namespace clothbench {

/// Name of the scene under which material cards stand in a study's folder.
inline constexpr const char* kMaterialCardScene = "material-card";

/// The effective Y and B of a solver at one setting, measured on patch scenes (scenario/material_patches.hpp) through
/// ClothSolver alone. `record` is a cell like any other, without trials and positions: `summary` has the moduli over
/// what the scenes state as material_E_0, material_B_45, ... and material_unrest, the greatest change of one of them
/// over the last quarter of a second; header.scenario_json the patches' scenes. Each patch runs until its modulus rests
/// to 1e-4 or its scene ends (3 s); one that takes more than `limit_s` of wall time, or that fails, leaves its moduli
/// missing and is named in the outcome's message. Solvers that ignore stretch are `unsupported`.
/// `bending` false: without the patches of B.
CellRecord measure_material(const SolverEntry&, const nlohmann::json& settings, const std::string& setting, bool full,
                            const DeviceOptions&, const std::string& protocol, double limit_s = 20,
                            bool bending = true);

/// A card that could not be measured, for instance since the process that was at it crashed.
CellRecord failed_material(const SolverEntry&, const std::string& setting, const Outcome&, const std::string& protocol);

/// The card of `clothbench card`, a plugin's in a child; one whose child crashes is a card that could not be measured.
CellRecord ask_material(Guard&, StudyRuns&, const SolverEntry&, const nlohmann::json& settings,
                        const std::string& setting, bool full);

/// Settings at which `clothbench card` looks for a dependence: four times as many substeps, four times as many
/// iterations, of integer settings of those names (1024 where the default is 0, "the solver chooses"). By short name.
std::map<std::string, nlohmann::json> swept_settings(const SolverInfo&, const nlohmann::json& complete);

}  // namespace clothbench

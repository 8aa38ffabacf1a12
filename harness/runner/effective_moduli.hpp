#pragma once
#include <filesystem>
#include <map>
#include <string>

#include "clothbench/record.hpp"
#include "clothbench/solver.hpp"
#include "runner/study_runs.hpp"

namespace clothbench {

/// Name of the scene under which effective moduli stand in a study's folder.
inline constexpr const char* kModuliScene = "effective-moduli";

/// The effective Y and B of a solver at one setting, measured on patch scenes (scenario/material_patches.hpp) through
/// ClothSolver alone. `record` is a run like any other, without trials and positions: `summary` has the moduli over
/// what the scenes state as material_E_0, material_B_45, ... and material_unrest, the greatest change of one of them
/// over the last quarter of a second; header.scenario_json the patches' scenes. Each patch runs until its modulus rests
/// to 1e-4 or its scene ends (3 s); one that takes more than `limit_s` of wall time, or that fails, leaves its moduli
/// missing and is named in the outcome's message. Solvers that ignore stretch are `unsupported`.
/// `bending` false: without the patches of B.
RunRecord measure_material(const SolverEntry&, const nlohmann::json& settings, const std::string& setting, bool full,
                           const DeviceOptions&, const std::string& protocol, double limit_s = 20, bool bending = true);

/// a measurement that could not be measured, for instance since the process that was at it crashed.
RunRecord failed_material(const SolverEntry&, const std::string& setting, const Outcome&, const std::string& protocol);

/// The measurement of `clothbench moduli`, a plugin's in a child; one whose child crashes is a measurement that could
/// not be measured.
RunRecord ask_material(Guard&, StudyRuns&, const SolverEntry&, const nlohmann::json& settings,
                       const std::string& setting, bool full);

/// Settings at which `clothbench moduli` looks for a dependence: four times as many substeps, four times as many
/// iterations, of integer settings of those names (1024 where the default is 0, "the solver chooses"). By short name.
std::map<std::string, nlohmann::json> swept_settings(const SolverInfo&, const nlohmann::json& complete);

}  // namespace clothbench

#pragma once
#include <map>
#include <string>

#include "clothbench/record.hpp"
#include "clothbench/solver.hpp"
#include "runner/study_runs.hpp"

namespace clothbench {

/// Scene name under which effective moduli are stored in a study's folder.
inline constexpr const char* kModuliScene = "effective-moduli";

/// Which patches are measured: those of grids that stretch alone, all of grids, or all with those of triangle meshes.
enum class PatchChoice { Stretch, Grids, GridsAndMeshes };

/// The effective Y and B of a solver at one setting, measured on patch scenes (scenario/material_patches.hpp) through
/// ClothSolver alone. Returns a run like any other, without trials and positions. Its `summary` has the moduli over
/// those that the scenes state, as material_E_0, material_B_45, ..., and material_unrest, the greatest change of any of
/// them over the last quarter of a second; header.scenario_json has the patches' scenes. Each patch runs until its
/// modulus is steady to 1e-4 or its scene ends (3 s). A patch that takes more than `limit_s` of wall time, or fails,
/// leaves its moduli missing and is named in the outcome's message. Solvers that ignore stretch are `unsupported`.
RunRecord measure_material(const SolverEntry&, const nlohmann::json& settings, const std::string& setting, bool full,
                           const DeviceOptions&, const std::string& protocol, double limit_s = 20,
                           PatchChoice = PatchChoice::Grids);

/// The record of a measurement that failed, for example because its process crashed.
RunRecord failed_material(const SolverEntry&, const std::string& setting, const Outcome&, const std::string& protocol);

/// The measurement of `clothbench moduli`, in a child for a plugin; a full one has meshes too. If the child crashes,
/// the result is a failed measurement.
RunRecord ask_material(Guard&, StudyRuns&, const SolverEntry&, const nlohmann::json& settings,
                       const std::string& setting, bool full);

/// Settings at which `clothbench moduli` checks for a dependence: four times as many substeps, four times as many
/// iterations, for integer settings of those names (1024 if the default is 0, "the solver chooses"). By short name.
std::map<std::string, nlohmann::json> swept_settings(const SolverInfo&, const nlohmann::json& complete);

}  // namespace clothbench

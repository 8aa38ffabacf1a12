#pragma once
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "base/table.hpp"
#include "clothbench/record.hpp"

namespace clothbench {

/// Greatest relative deviation of a modulus that the solver has as a parameter: between settings, and from half of the
/// modulus measured at twice the stiffness.
inline constexpr double kHeldModulus = 0.05;

/// True for a run that measured effective moduli (harness/runner/effective_moduli.hpp).
bool is_moduli_run(const RunRecord&);

/// Whether each stiffness of a scene is a parameter of the solver at all settings: "" if so, otherwise why not. It is
/// one if doubling it doubles the measured modulus, and if every measured setting gives the modulus of the default
/// setting, both within kHeldModulus. "not measured" if the default setting has no measurement.
struct MaterialVerdict {
  std::string strip;    ///< Y of scenes with `shear: false`
  std::string sheet;    ///< Y of the others
  std::string bending;  ///< B
};

/// All measured moduli of one solver: the full measurement first, then other settings in the order given.
struct SolverMaterial {
  std::string solver;
  std::vector<const RunRecord*> moduli;
  MaterialVerdict verdict;
};

/// By solver, in the order of first appearance. `runs` may hold other runs, and must outlive the result.
std::vector<SolverMaterial> solver_materials(const std::vector<RunRecord>& runs);

/// The stiffnesses that a scene's exact solution depends on.
struct StiffnessNeed {
  bool strip = false, sheet = false, bending = false;
  bool any() const { return strip || sheet || bending; }
};

/// As computed from the scene's truth and stored with its runs (harness/metrics/truth_dependence.hpp): the stiffnesses
/// for which a change of 1 % changes the ranked quantity by 1e-4 or more. None if nothing is stored.
StiffnessNeed stiffness_need(const RunRecord&);

/// Why a solver at this setting cannot be ranked on a scene that depends on these stiffnesses: "" if it can be, or if
/// no measurement shows otherwise. Where the modulus depends on settings, those whose own measured modulus is within
/// kHeldModulus of the requested one can be.
std::string stiffness_flag(const std::vector<SolverMaterial>&, const std::string& solver, const std::string& setting,
                           const StiffnessNeed&);

/// The same for a run and its scene. What its solver's plan says of this scene (LeftOut::no_parameter) comes first.
std::string stiffness_flag(const std::vector<SolverMaterial>&, const RunRecord&);

/// Rows: solvers and settings; columns: moduli, relative to those that the scenes state.
Table material_table(const std::vector<SolverMaterial>&);
/// The verdicts alone.
Table material_verdicts(const std::vector<SolverMaterial>&);
nlohmann::json material_json(const std::vector<SolverMaterial>&);

}  // namespace clothbench

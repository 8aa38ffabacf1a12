#pragma once
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "base/table.hpp"
#include "clothbench/record.hpp"

namespace clothbench {

/// A modulus that differs by no more than this between settings, and from half of what a doubled one gives, is the
/// solver's parameter.
inline constexpr double kHeldModulus = 0.05;

/// True for a run that holds effective moduli (harness/runner/effective_moduli.hpp).
bool is_moduli_run(const RunRecord&);

/// Whether one of a scene's stiffnesses reaches the cloth: "" if so, otherwise why not. A solver listens if doubling
/// the stiffness doubles what is measured, and holds if every setting measured gives what the default gives, both
/// within kHeldModulus. "not measured" where there is no measured, or no value at the default setting.
struct MaterialVerdict {
  std::string strip;    ///< Y of scenes with `shear: false`
  std::string sheet;    ///< Y of the others
  std::string bending;  ///< B
};

/// All moduli of one solver: the full one first, then those of other settings in the order given.
struct SolverMaterial {
  std::string solver;
  std::vector<const RunRecord*> moduli;
  MaterialVerdict verdict;
};

/// By solver, in the order of first appearance. `runs` may hold others, and must outlive the answer.
std::vector<SolverMaterial> solver_materials(const std::vector<RunRecord>& runs);

/// The stiffnesses that a scene's answer depends on.
struct StiffnessNeed {
  bool strip = false, sheet = false, bending = false;
  bool any() const { return strip || sheet || bending; }
};

/// As measured on its truth and stored with its runs (harness/metrics/truth_dependence.hpp): those whose change by a
/// hundredth moves what ranks the runs by 1e-4 or more. None where nothing is stored.
StiffnessNeed stiffness_need(const RunRecord&);

/// Why this solver's stiffness cannot be judged on a scene with these needs: "" if it can be, or no measured says
/// otherwise.
std::string stiffness_flag(const std::vector<SolverMaterial>&, const std::string& solver, const StiffnessNeed&);

/// Rows: solvers at their settings; moduli over what the scenes state.
Table material_table(const std::vector<SolverMaterial>&);
/// The verdicts alone.
Table material_verdicts(const std::vector<SolverMaterial>&);
nlohmann::json material_json(const std::vector<SolverMaterial>&);

}  // namespace clothbench

#pragma once
#include <nlohmann/json_fwd.hpp>
#include <string>
#include <vector>

#include "clothbench/solver.hpp"
#include "runner/again.hpp"

namespace clothbench {

/// A closed form of friction: what of which scene, and what is asked of it.
struct FrictionForm {
  const char *scene, *head;
  bool threshold;
  double scale;    ///< to the head's unit
  double at_most;  ///< in the head's unit
};
/// Coulomb's cone on a slope, uniform deceleration, Euler and Eytelwein's belt on a polygon, Lagrange's strip over a
/// cylinder; harness/truth has them. Bounds: what a solver's author should want.
const std::vector<FrictionForm>& friction_forms();

/// Of the form's scene with the overrides `set`, a plugin's in a child: {scene, what, error, at_most, text}, the error
/// in the form's unit, signed for thresholds, null where it is unsupported, failed or crashed; `crash`, how a plugin's
/// process ended instead, is empty else.
nlohmann::json ask_friction(Guard&, const FrictionForm&, const SolverEntry&, const nlohmann::json& settings,
                            const std::vector<std::string>& set, const DeviceOptions&, std::string& crash);

}  // namespace clothbench

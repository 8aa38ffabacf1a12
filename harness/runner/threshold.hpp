#pragma once
#include <nlohmann/json_fwd.hpp>

#include "clothbench/scene.hpp"
#include "clothbench/solver.hpp"
#include "runner/again.hpp"

namespace clothbench {

/// Where a scene begins to hold for one solver, against the closed form.
struct FoundThreshold {
  double exact = 0, found = 0;  ///< coefficients of friction
  double error = 0;             ///< in the card's own words: degrees of the critical angle, share of the overhang
  bool holds_at_least = false, slips_at_most = false;  ///< at 0.5 and 1.5 times the exact one: found is then that end
  bool failed = false;                                 ///< a run did: nothing was found, `found` and `error` are NaN
  int runs = 0;
};

/// Bisects the coefficient of friction between 0.5 and 1.5 of the exact one, to 1e-3 of it; each try is a run of the
/// whole scene. A run that fails ends it: a cloth that blows up says nothing of friction. Throws Error if the scene's
/// card has no threshold (see truth/card.hpp) or the solver cannot run it.
FoundThreshold find_threshold(const Scene&, const SolverEntry&, const nlohmann::json& settings, const DeviceOptions&);

/// find_threshold as `clothbench threshold --json` tells it, a plugin's in a child: {scene, solver, exact, found,
/// error, error_name, error_units, bound, failed, runs}, or {scene, solver, crashed}.
nlohmann::json ask_threshold(Guard&, const Scene&, const SolverEntry&, const nlohmann::json& settings,
                             const DeviceOptions&);

/// |quantity - truth| over its scale (see truth/card.hpp) at the end of a run of the whole scene; NaN if the run fails.
/// Throws Error if the scene has no card.
double end_error(const Scene&, const SolverEntry&, const nlohmann::json& settings, const DeviceOptions&);

}  // namespace clothbench

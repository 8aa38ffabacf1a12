#pragma once
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "clothbench/record.hpp"
#include "truth/reference_case.hpp"

namespace clothbench {

/// A closed form of friction: the scene, the quantity compared, and its bound.
struct FrictionForm {
  std::string scene, head;
  bool threshold;
  double scale;    ///< to the head's unit
  double at_most;  ///< in the head's unit
};
/// Coulomb's cone on a slope, uniform deceleration, Euler and Eytelwein's belt on a polygon. Except for thresholds, the
/// bounds are the tolerances of the reference cases (truth/reference_case.hpp).
const std::vector<FrictionForm>& friction_forms();

/// Protocols under which runs are stored: the runs of a search, and the runs judged only by their end state.
inline constexpr const char* kThresholdProtocol = "threshold";
inline constexpr const char* kFrictionProtocol = "friction";

/// The coefficient of friction from which a scene holds with one solver, compared with the closed form.
struct FoundThreshold {
  double exact = 0, found = 0;  ///< coefficients of friction
  double error = 0;  ///< as the reference case defines it: degrees of the critical angle, or share of the overhang
  bool holds_at_least = false, slips_at_most = false;  ///< at 0.5 and 1.5 times `exact`: `found` is then that end
  bool failed = false;                                 ///< a run failed: nothing was found, `found` and `error` are NaN
  int runs = 0;
};

/// Bisects the coefficient of friction between 0.5 and 1.5 times the exact value, to 1e-3 of it. `holds` returns the
/// result of a run at one coefficient, or none if the run failed. None ends the search: a cloth that blows up gives no
/// information on friction. The search is deterministic, so stored runs reproduce its result.
FoundThreshold search_threshold(const truth::Threshold&,
                                const std::function<std::optional<bool>(double friction)>& holds);

/// Name of the scene variant that is run at one coefficient.
std::string tried_scene(const std::string& scene, double friction);

/// Whether the cloth of a whole run stayed in place; none if the run failed. A strip that has left its cylinder has no
/// displacement over it and counts as slipped.
std::optional<bool> stayed(const truth::Threshold&, const RunRecord& run);

/// |quantity - truth| over its scale (see truth/reference_case.hpp) at the end of a whole run of the scene; NaN if the
/// run failed. Throws Error if the scene has no reference case.
double end_error(const Scene&, const RunRecord& run);

}  // namespace clothbench

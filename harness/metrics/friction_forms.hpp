#pragma once
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "clothbench/record.hpp"
#include "truth/reference_case.hpp"

namespace clothbench {

/// A closed form of friction: what of which scene, and what is asked of it.
struct FrictionForm {
  const char *scene, *head;
  bool threshold;
  double scale;    ///< to the head's unit
  double at_most;  ///< in the head's unit
};
/// Coulomb's cone on a slope, uniform deceleration, Euler and Eytelwein's belt on a polygon, Lagrange's strip over a
/// cylinder. Bounds: what a solver's author should want.
const std::vector<FrictionForm>& friction_forms();

/// Protocols that runs are stored by: those of a search, and those whose end alone is judged.
inline constexpr const char* kThresholdProtocol = "threshold";
inline constexpr const char* kFrictionProtocol = "friction";

/// Where a scene begins to hold for one solver, against the closed form.
struct FoundThreshold {
  double exact = 0, found = 0;  ///< coefficients of friction
  double error = 0;  ///< in the reference case's own words: degrees of the critical angle, share of the overhang
  bool holds_at_least = false, slips_at_most = false;  ///< at 0.5 and 1.5 times the exact one: found is then that end
  bool failed = false;                                 ///< a run did: nothing was found, `found` and `error` are NaN
  int runs = 0;
};

/// Bisects the coefficient of friction between 0.5 and 1.5 of the exact one, to 1e-3 of it. `holds` answers for a run
/// at one coefficient; none where there is no answer, which ends the search: a cloth that blows up says nothing of
/// friction. The same answers lead to the same questions, so stored runs tell again what was found.
FoundThreshold search_threshold(const truth::Threshold&,
                                const std::function<std::optional<bool>(double friction)>& holds);

/// Name of the scene in the form that is run at one coefficient.
std::string tried_scene(const std::string& scene, double friction);

/// Whether the cloth of a whole run stayed where it was; none where the run failed. A strip that is no longer over its
/// cylinder has no displacement over it, and did not stay.
std::optional<bool> stayed(const truth::Threshold&, const RunRecord& run);

/// |quantity - truth| over its scale (see truth/reference_case.hpp) at the end of a whole run of the scene; NaN if the
/// run failed. Throws Error if the scene has no reference case.
double end_error(const Scene&, const RunRecord& run);

}  // namespace clothbench

#pragma once
#include <filesystem>
#include <functional>
#include <map>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>

#include "clothbench/scene.hpp"

namespace clothbench {

/// The quantity of a scene's reference case as computed by the solver `reference`, with its uncertainty, beside the
/// truth.
struct ReferenceResult {
  double truth = 0;                               ///< from the reference case, same grid; of a mesh, the continuum's
  double value = 0;                               ///< extrapolated, mean of both integrators
  double uncertainty = 0;                         ///< U_ref over the scale of the quantity
  double order_bdf2 = 0, order_conservative = 0;  ///< observed; NaN where there is none
  double truth_distance = 0;                      ///< |value - truth| / scale
  double space_error =
      0;  ///< this grid's truth, or the finest run of this mesh, against the continuum, in the ranking error

  /// Names as in a run's summary: reference_value, reference_uncertainty, ... truth_space_error.
  std::map<std::string, double> scalars() const;
};

/// Resolution of the reference runs.
struct ReferenceRules {
  int moving_steps = 512;  ///< least number for a whole scene on the coarsest level
  int settling_substeps =
      8;  ///< per frame, for a scene that comes to rest: enough for the midpoint rule to damp the initial motion
  double tolerance = 1e-8;  ///< of Newton's method
};

/// Runs three levels of time steps, each half the one before, with two integrators, and the coarsest also with a tenth
/// of the tolerance. Extrapolation and uncertainty as the grid convergence index of Roache (J. Fluids Eng. 116, 1994,
/// 405):
///   p = log2((f3 - f2)/(f2 - f1)),  f* = f1 + (f1 - f2)/(2^p - 1),
///   U = max(Fs |f1 - f2|/(2^p - 1), |f*_A - f*_B|, |f(tol) - f(tol/10)|),
/// where f1 is the finest, and Fs = 1.25, or Fs = 3 with p = 2 if the observed p is off by more than 0.5. A shape at
/// rest does not depend on the step: f* = f1, U = max(|f1 - f2|, |f1_A - f1_B|, tolerance, change of f1 in the last
/// tenth of the run), and no order is observed. Rows of a grid that do not shear move alike, so only two of them are
/// run. A triangle mesh has no truth of its own. Its space_error is taken from the finest runs, the larger of both
/// integrators. Throws Error if the scene has no reference case, if the build has no solver `reference`, or if a run of
/// it fails.
ReferenceResult compute_reference(const Scene&, const ReferenceRules& = {});

/// Results for these scenes by their SHA-256. Those missing from `cache` are computed on all cores and added to it (one
/// file each, found again by reference_key; an unreadable file, or one of another key, counts as missing). `note` is
/// called before each computation. Scenes without a reference case are skipped; so are all scenes if the build has no
/// solver `reference`. The reference solver has no contact. For contact scenes the truth is a closed form;
/// `value` is NaN and `uncertainty` is 0.
std::map<std::string, ReferenceResult> references(const std::vector<const Scene*>& scenes,
                                                  const std::filesystem::path& cache,
                                                  const std::function<void(const std::string&)>& note,
                                                  const ReferenceRules& = {});

/// Everything that a scene's reference value depends on: the scenario, the reference solver's version and complete
/// settings, the rules of the runs, and this program's file, in place of the code of solver, truths and scenes.
nlohmann::json reference_key(const Scene&, const ReferenceRules&);

/// The value stored in `folder` for this key. None if the file is missing, unreadable or of another key.
std::optional<ReferenceResult> read_reference(const std::filesystem::path& folder, const nlohmann::json& key);
void write_reference(const std::filesystem::path& folder, const nlohmann::json& key, const ReferenceResult&);

}  // namespace clothbench

#pragma once
#include <filesystem>
#include <functional>
#include <map>
#include <string>

#include "clothbench/scene.hpp"

namespace clothbench {

/// The quantity of a scene's known as computed by the solver `reference`, with its uncertainty, beside the truth.
struct ReferenceResult {
  double truth = 0;                               ///< the reference case's, same mesh
  double scale = 1;                               ///< of the quantity: errors below are over it
  double value = 0;                               ///< extrapolated, mean of both integrators
  double uncertainty = 0;                         ///< U_ref / scale
  double order_bdf2 = 0, order_conservative = 0;  ///< observed; NaN where there is none
  double truth_distance = 0;                      ///< |value - truth| / scale
  double space_error = 0;                         ///< of the truth: this mesh against the continuum, in what ranks runs
  int least_substeps = 0;                         ///< of the three levels, each twice the one before

  /// As they stand in a run's summary: reference_value, reference_uncertainty, ... truth_space_error.
  std::map<std::string, double> scalars() const;
};

/// How finely the reference runs.
struct ReferenceRules {
  int moving_steps = 512;  ///< of a whole scene, at least, on the coarsest level
  int settling_substeps =
      8;  ///< a frame, of a scene that comes to rest: enough for the midpoint rule to damp what the start set going
  double tolerance = 1e-8;  ///< of Newton's method
};

/// Three levels of time steps, each half the one before, with two integrators; and the coarsest with a tenth of the
/// tolerance. Extrapolation and uncertainty as the grid convergence index of Roache (J. Fluids Eng. 116, 1994, 405):
///   p = log2((f3 - f2)/(f2 - f1)),  f* = f1 + (f1 - f2)/(2^p - 1),
///   U = max(Fs |f1 - f2|/(2^p - 1), |f*_A - f*_B|, |f(tol) - f(tol/10)|),
/// f1 the finest, Fs = 1.25, or 3 with p = 2 kept where the observed one is off by more than 0.5. A shape at rest does
/// not depend on the step: f* = f1, U = max(|f1 - f2|, |f1_A - f1_B|, tolerance, what f1 moved in the last tenth of the
/// run), and no order is observed. The scene's rows move alike, so two of them are run. Throws Error if the scene has
/// no reference case, the build no solver `reference`, or a run of it fails.
ReferenceResult compute_reference(const Scene&, const ReferenceRules& = {});

/// Results for these scenes by their SHA-256, those that `cache` lacks computed on all cores and added to it (one file
/// each, found again by reference_key; one that is unreadable or of another key counts as lacking). `note` is called
/// for each before it is begun. Scenes without a reference case are passed over; so are all where the build has no
/// solver `reference`. Contact is out of its scope: those scenes' truth is a closed form, with no value of the
/// reference and an uncertainty of 0.
std::map<std::string, ReferenceResult> references(const std::vector<const Scene*>& scenes,
                                                  const std::filesystem::path& cache,
                                                  const std::function<void(const std::string&)>& note,
                                                  const ReferenceRules& = {});

}  // namespace clothbench

#pragma once
#include <filesystem>
#include <functional>
#include <map>
#include <memory>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <vector>

#include "clothbench/record.hpp"
#include "clothbench/scene.hpp"
#include "clothbench/solver.hpp"

namespace clothbench {

/// The quantity of a scene's reference case as computed by the solver `reference`, with its uncertainty, and the exact
/// value.
struct ReferenceResult {
  double truth = kMissing;  ///< exact value, on the same grid; for a mesh, the continuum's
  double value = kMissing;  ///< extrapolated, mean over both integrators
  double uncertainty = 0;   ///< U, divided by the scale of the quantity
  double order_bdf2 = kMissing, order_conservative = kMissing, order_xpbd = kMissing;  ///< observed order; NaN if none
  double truth_distance = kMissing;                                                    ///< |value - truth| / scale
  /// Ranking error of this grid's exact solution, or of this mesh's finest run, against the continuum.
  double space_error = kMissing;
  double spread = kMissing;  ///< only of converge(): standard deviation of the starts' motions, over the longer side
  std::shared_ptr<const std::vector<double>> mean = {};  ///< only of converge(): motion at the material points [m]

  /// Scalars by their names in a run's summary: reference_value, reference_uncertainty, ... truth_space_error.
  std::map<std::string, double> scalars() const;
};

/// Resolution of the runs with the reference solver.
struct ReferenceRules {
  int moving_steps = 512;  ///< minimum for a whole scene on the coarsest level
  int settling_substeps =
      8;  ///< per frame, for a scene that comes to rest: enough to let the midpoint rule damp the initial motion
  double tolerance = 1e-8;  ///< residual at which Newton's method stops
};

/// Runs three levels of time steps, each half as long as the one before, with two integrators; the coarsest also with a
/// tenth of the tolerance. Extrapolation and uncertainty follow the grid convergence index of Roache (J. Fluids Eng.
/// 116, 1994, 405):
///   p = log2((f3 - f2)/(f2 - f1)),  f* = f1 + (f1 - f2)/(2^p - 1),
///   U = max(Fs |f1 - f2|/(2^p - 1), |f*_A - f*_B|, |f(tol) - f(tol/10)|),
/// where f1 is from the finest level, A and B are the integrators, and Fs = 1.25, or Fs = 3 with p = 2 if the observed
/// p is off by more than 0.5. A shape at rest does not depend on the step: f* = f1, U = max(|f1 - f2|, |f1_A - f1_B|,
/// tolerance, change of f1 in the last tenth of the run), and no order is observed. Rows of a grid without shear move
/// alike, so only two of them are run. A triangle mesh has no exact solution of its own; its space_error is the larger
/// error of the two integrators' finest runs. Throws Error if the scene has no reference case, if the build has no
/// solver `reference`, or if a run of this solver fails.
ReferenceResult compute_reference(const Scene&, const ReferenceRules& = {});

/// The converged solution of a scene that asks for one (Scene::converged): the mean of solver `xpbd` over nudged
/// starts. The uncertainty is the larger of the starts' spread, which is the error that chaos gives to any single run,
/// and the distance of the mean from the one with half the substeps; a quarter of them gives the order. The space error
/// is the distance of the mean from the one on the fine grid, if the scene names a grid. Everything else is NaN.
ReferenceResult converge(const Scene&, const DeviceOptions&);

/// Motions of a scene from starts that differ by a nudge.
struct Ensemble {
  std::vector<double> mean;  ///< positions [m] at the material points, frame by frame
  double spread;             ///< motion_distance of the standard deviations from 0
};

/// Runs a solver from each start of scene.converged. The whole cloth moves by at most `nudge_m` along each axis, so a
/// start does not depend on the grid. Throws Error if a run fails.
Ensemble ensemble_of(const Scene&, const SolverEntry&, const nlohmann::json& settings, const DeviceOptions&);

/// RMS distance over space and time of two motions at the material points, divided by the longer side.
double motion_distance(const Scene&, const std::vector<double>& a, const std::vector<double>& b);

/// motion_distance of a pass from the mean of an ensemble; NaN if it has not as many frames.
double converged_error(const Scene&, const AccuracyPass&, const std::vector<double>& mean);

/// Results for these scenes by their SHA-256. Results missing from `cache` are computed on all cores and added to it,
/// one file each, found by reference_key; an unreadable file, or one for another key, counts as missing. `note` is
/// called before each computation. Scenes without reference case or converged solution are skipped, and scenes whose
/// solver (`reference` or `xpbd`) the build lacks. The reference solver has no contact: contact scenes with a reference
/// case have a closed-form solution, with `value` NaN and `uncertainty` 0.
std::map<std::string, ReferenceResult> references(const std::vector<const Scene*>& scenes,
                                                  const std::filesystem::path& cache,
                                                  const std::function<void(const std::string&)>& note,
                                                  const ReferenceRules& = {}, const DeviceOptions& = {});

/// Everything on which a scene's reference value depends: the scenario, the solver's version and complete
/// settings, the rules of the runs, and a hash of this program's file, which stands for the code.
nlohmann::json reference_key(const Scene&, const ReferenceRules&);

/// The value stored in `folder` for this key; none if the file is missing, unreadable or for another key.
std::optional<ReferenceResult> read_reference(const std::filesystem::path& folder, const nlohmann::json& key);
void write_reference(const std::filesystem::path& folder, const nlohmann::json& key, const ReferenceResult&);

}  // namespace clothbench

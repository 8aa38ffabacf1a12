#pragma once
#include <map>
#include <string>

#include "metrics/metric.hpp"
#include "truth/reference_case.hpp"

namespace clothbench {

/// Evaluates the frames of one scene against its reference case.
class TruthJudge {
 public:
  /// Throws Error if the scene has no reference case, or does not meet its requirements.
  explicit TruthJudge(const Scene&);
  const Scene& scene() const { return scene_; }
  const truth::ReferenceCase& reference_case() const { return case_; }
  TruthErrors judge(int frame, const ClothState&) const;
  /// The ranking error of frames at these times (a run's `truth_error`): RMS over time; at rest, of the last frame.
  double ranking_error(const std::vector<double>& times_s, const std::vector<TruthErrors>&) const;
  /// Ranking error (see ReferenceCase) of the grid's exact solution against the continuum, which smaller time steps
  /// cannot reduce. NaN for a sheet with shear and for a mesh: no exact solution is known (compute_reference).
  double space_error() const;

 private:
  double lattice_e2(const std::vector<double>& a, const std::vector<double>& b) const;
  double space_error(int frame) const;

  const Scene& scene_;
  truth::ReferenceCase case_;
  truth::MaterialLattice lattice_;
  truth::LatticeSampler sampler_;
};

/// Scenes whose strips conserve energy (metric energy_rise): no damping, shear, bending, hands or colliders.
bool keeps_energy(const Scene&);

/// Sensitivity of a scene's exact solution to its stiffnesses: `truth_dependence_Y` and `truth_dependence_B`. Each is
/// the change of the ranking value (quantity or positions, truth::ReferenceCase) per logarithm of the membrane
/// stiffness or the bending rigidity, estimated with 10 % more of this stiffness. 1: the value changes by 1 %
/// for 1 % more stiffness. 0: the scene has no such stiffness. For a moving solution it is the maximum over a few
/// frames. Empty for a scene without a reference case.
std::map<std::string, double> truth_dependence(const Scene&);

/// Bounds on two scalars of a complete run of a scene with an exact solution: the distance of the positions
/// (`truth_e2`) and the error of the reference case's quantity (`truth_quantity_error`). Both are norms of a
/// difference, so a motion that is too small fails as one that is too large does. Each bound is
///   (tolerance + mesh) * moved + rounding, or, if moved is 0: tolerance at rest + rounding
/// moved: the scalar of a cloth that stays at its start; mesh: error of a triangle mesh or of a strip with a smooth
/// law, relative to the exact motion; rounding: change of the scalar if positions are rounded to float32.
struct ExactBound {
  double e2 = kMissing, quantity_error = kMissing;
};

/// The judge's scene is the one that was run. Throws Error if its reference case defines no tolerance.
ExactBound exact_bound(const TruthJudge&);

}  // namespace clothbench

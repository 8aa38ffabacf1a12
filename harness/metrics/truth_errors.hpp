#pragma once
#include <map>
#include <string>

#include "metrics/metric.hpp"
#include "truth/reference_case.hpp"

namespace clothbench {

/// Judges the frames of one scene by its reference case.
class TruthJudge {
 public:
  /// Throws Error if the scene has no reference case, or does not meet its requirements.
  explicit TruthJudge(const Scene&);
  const Scene& scene() const { return scene_; }
  const truth::ReferenceCase& reference_case() const { return case_; }
  TruthErrors judge(int frame, const ClothState&) const;
  /// The ranking error of frames judged at these times, as a run's `truth_error`: RMS over time, at rest the last.
  double ranking_error(const std::vector<double>& times_s, const std::vector<TruthErrors>&) const;
  /// The ranking error (see ReferenceCase) of the mesh's own truth against the continuum: a lower bound that no smaller
  /// time step removes. NaN for a sheet that shears and for a mesh, whose truth is not known (see compute_reference).
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

/// How much a scene's truth depends on its stiffnesses: `truth_dependence_Y` and `truth_dependence_B`. Each is the
/// change of what ranks the scene's runs (quantity or positions, truth::ReferenceCase) with the logarithm of the
/// membrane stiffness or the bending rigidity, from evaluating the reference case at 10 % more of each. 1 means that it
/// changes by 1 % for 1 % more stiffness; 0 that the scene has no such stiffness. For truths in motion it is the
/// maximum over a few frames. Empty for a scene without a reference case.
std::map<std::string, double> truth_dependence(const Scene&);

/// Bounds on two scalars of a whole run of a scene with an exact solution: the distance of the positions (`truth_e2`)
/// and the error of the reference case's quantity (`truth_quantity_error`). Both are norms of a difference, so too
/// small a value fails like too large a one. Each bound is
///   tolerance * moved + mesh + rounding
/// moved: the scalar of a cloth that keeps its start (if 0, the tolerance at rest replaces this term); mesh: the error
/// of a triangle mesh itself; rounding: the change of the scalar by positions in float32.
struct ExactBound {
  double e2 = kMissing, quantity_error = kMissing;
};

/// The judge's scene is the one that was run. Throws Error if its reference case has no tolerance.
ExactBound exact_bound(const TruthJudge&);

}  // namespace clothbench

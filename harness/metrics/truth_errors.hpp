#pragma once
#include <string>

#include "clothbench/record.hpp"
#include "clothbench/scene.hpp"
#include "clothbench/solver.hpp"
#include "truth/card.hpp"
#include "truth/norms.hpp"

namespace clothbench {

/// Distance of one frame from the scene's truth. Positions are compared on the fixed 33 x 33 material lattice, over the
/// longer side. A state that is not finite gives NaN; so does what the card has no answer for.
struct TruthErrors {
  double e2 = kMissing, greatest = kMissing;  ///< positions: RMS, greatest
  double speed = kMissing;                    ///< speeds: RMS, over the card's speed scale
  double quantity = kMissing;                 ///< the card's quantity of this state
  double quantity_error = kMissing;           ///< |quantity - true| over the card's scale
  double stretch_rms = kMissing, stretch_p99 = kMissing,
         stretch_max = kMissing;  ///< strain less true strain, edges along u
};

/// Judges the frames of one scene by its card.
class TruthJudge {
 public:
  /// Throws Error if the scene has no card, or is not what its card answers.
  explicit TruthJudge(const Scene&);
  const truth::Card& card() const { return card_; }
  TruthErrors judge(int frame, const ClothState&) const;
  /// What ranks runs (see Card), of the mesh's own truth against the continuum: the floor that no time step removes.
  double space_error() const;

 private:
  double lattice_e2(const std::vector<double>& a, const std::vector<double>& b) const;
  double space_error(int frame) const;

  const Scene& scene_;
  truth::Card card_;
  truth::MaterialLattice lattice_;
  truth::LatticeSampler sampler_;
};

/// Scenes whose strips keep kinetic, gravity's and spring energy (metric energy_rise): no damping, shear, bending,
/// hands or colliders.
bool keeps_energy(const Scene&);

}  // namespace clothbench

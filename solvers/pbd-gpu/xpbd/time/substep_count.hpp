#pragma once
#include <nlohmann/json_fwd.hpp>

#include "clothbench/scene.hpp"

namespace clothbench::pbd_gpu {

/// Links along the longer side; of a mesh as many as edges of its length fit.
double links_of_longer_side(const Cloth&);

/// Substeps of a frame: setting `substeps`, or if that is 0 the rule of setting `quality` (README, "Substeps"). In a
/// scene with contact the maximum of a frame.
int xpbd_substeps(const Scene&, const nlohmann::json& settings);

/// Substeps of a frame in which no collider can be near: as in the scene without colliders, and more where a kinematic
/// collider may have left the cloth strained in directions that tethers do not limit.
int contact_free_substeps(const Scene&, const nlohmann::json& settings);

/// Substeps that the speed of colliders needs, if that is more than the maximum. The cloth is then overstretched for
/// some frames, but passes through nothing. 0 if the maximum is sufficient.
int uncapped_substeps_if_capped(const Scene&, const nlohmann::json& settings);

/// Substeps from the largest displacement in a frame.
struct TravelLimit {
  double travel_m = 0;  ///< in a substep, where things are slow; infinity without colliders
  double faster = 1;    ///< divisor of travel_m for fast motion
  double layers_m = 0;  ///< in a substep, for layers of the cloth that touch; infinity without
  double wanted(double max_displacement_m) const;
};

/// Chooses the number of substeps of the next frame from the largest vertex displacement of the previous frame, for
/// cloth in contact with static colliders or itself. An impact needs many substeps; most frames have none.
/// - Displacement above the travel limit: more substeps, up to the scene's maximum.
/// - After an impact: at most 25 % fewer substeps per frame.
/// - At rest (four frames with less than 1/24 cell of displacement): half of the base, later a quarter. More than 1/6
///   cell restores the base. The two thresholds differ so that the count does not oscillate.
class SubstepController {
 public:
  SubstepController() = default;
  /// `adapts`: else every frame takes xpbd_substeps().
  SubstepController(const Scene&, const nlohmann::json& settings, bool adapts);
  void reset();
  bool adapts() const { return adapts_; }
  /// Substeps of a frame as long as the scene's.
  int substeps() const { return now_; }
  /// Before a frame. `cloth_m`: the largest displacement of a vertex in the last frame, in the time of a frame of the
  /// scene; infinity: unknown.
  void next(double cloth_m);

 private:
  void halve_if_quiescent(double cloth_m);

  TravelLimit rule_;
  int base_ = 1, max_ = 1, now_ = 1;
  bool adapts_ = false;
  double cell_m_ = 0;
  int halvings_ = 0;          ///< of the base
  int quiescent_frames_ = 0;  ///< since the last halving
};

}  // namespace clothbench::pbd_gpu

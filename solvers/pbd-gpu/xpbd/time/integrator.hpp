#pragma once
#include <nlohmann/json_fwd.hpp>
#include <string>

#include "clothbench/scene.hpp"

namespace clothbench::pbd_gpu {

/// Whether a scene gets a part of the method, and else why not.
struct FeatureDecision {
  bool enabled = false;
  std::string reason;
};

/// One substep of `xpbd` (xpbd/time/README.md). Backward Euler: history weight 0 and implicit_h_s = h. BDF2 with
/// variable steps: the prediction x + s (x - x_last) + h' v, and the same for v; constraints are solved for h'.
struct TimeStep {
  double implicit_h_s;      ///< h' [s]
  double history_weight;    ///< fraction of the last substep's change that the prediction repeats
  double damping_fraction;  ///< fraction of velocity that damping takes
  double force_scale;       ///< factor of all forces: 1 for backward Euler, 1 - damping fraction for BDF2
};
/// A substep of h_s after one of last_h_s. A cloth that does not use BDF2 takes backward Euler with explicit damping;
/// one that uses BDF2 takes implicit damping, and begins (last_h_s 0) with a substep of backward Euler.
TimeStep time_step(bool uses_bdf2, double h_s, double last_h_s, double damping_per_s);

/// Whether a scene is integrated by BDF2. The same for every cloth of the same features that nothing holds.
FeatureDecision bdf2_decision(const Scene&, const nlohmann::json& settings);
/// Whether its links get implicit tension (xpbd/time/README.md).
FeatureDecision tension_decision(const Scene&, const nlohmann::json& settings);

/// Whether its diagonals are solved where columns and rows will put the vertices (xpbd/time/README.md).
FeatureDecision splitting_correction_decision(const Scene&, const nlohmann::json& settings);

/// Whether links and masses are all alike in an elastic sheet that is held and touches nothing, so that its colours
/// may be coupled (xpbd/time/README.md); else why not.
FeatureDecision may_correct_splitting(const Scene&, const nlohmann::json& settings);
/// Implicit substeps of BDF2 in a frame that a stretch wave takes across as many cells as the correction bears.
double substeps_for_splitting(const Scene&);

/// True if pins or hands hold it.
bool is_held(const Scene&);
/// True if the scene has neither self-collision nor a collider that the cloth can reach. The motion is then the same
/// with and without its colliders. Meshes and kinematic colliders count as in reach.
bool is_contact_free(const Scene&);
/// Speed [m/s] at which a cloth that nothing holds meets static colliders: its first speed, and the speed of a fall
/// by the distance from its centre to the nearest of them. 0 if it is held or has none, or one that moves.
double impact_speed_m_per_s(const Scene&);

/// Substeps of a frame: setting `substeps`, or if that is 0 the rule of setting `quality` (README, "Substeps"). In a
/// scene with contact the maximum of a frame.
int xpbd_substeps(const Scene&, const nlohmann::json& settings);

/// The substeps that fast motion in contact asks for, where a frame's maximum is below; else 0.
int uncapped_substeps_if_capped(const Scene&, const nlohmann::json& settings);

/// Substeps of a frame in which no collider can be near: as in the scene without colliders, and more where a kinematic
/// collider may have left the cloth strained in directions that tethers do not limit.
int contact_free_substeps(const Scene&, const nlohmann::json& settings);

/// Chooses the number of substeps of the next frame, and of lists of pairs, from the largest displacement in the last
/// one, for cloth in contact with static colliders or itself (xpbd/time/README.md, "By frame"). An impact needs many;
/// most frames have none.
class SubstepController {
 public:
  SubstepController() = default;
  /// `adapts`: else every frame takes xpbd_substeps().
  SubstepController(const Scene&, const nlohmann::json& settings, bool adapts);
  void reset();
  bool adapts() const { return adapts_; }
  /// Substeps of a frame as long as the scene's.
  int substeps() const { return now_; }
  /// Lists of candidate pairs that such a frame makes one after another.
  int lists() const { return lists_; }
  /// Before a frame. `cloth_m`: the largest displacement of a vertex in the last frame, in the time of a frame of the
  /// scene; infinity: unknown.
  void next(double cloth_m);

 private:
  void halve_if_quiescent(double cloth_m);

  double max_travel_m_ = 0;  ///< in a substep; infinity without colliders and self-contact
  int base_ = 1, max_ = 1, now_ = 1, lists_ = 1;
  bool adapts_ = false;
  double cell_m_ = 0;
  int halvings_ = 0;          ///< of the base
  int quiescent_frames_ = 0;  ///< since the last halving
};

}  // namespace clothbench::pbd_gpu

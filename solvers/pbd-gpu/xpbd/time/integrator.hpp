#pragma once
#include <nlohmann/json_fwd.hpp>
#include <string>

#include "clothbench/scene.hpp"

namespace clothbench::pbd_gpu {

/// Whether a part of the method is on for a scene, and if not, the reason.
struct FeatureDecision {
  bool enabled = false;
  std::string reason;
};

/// One substep of `xpbd` (xpbd/time/README.md). Backward Euler: history weight 0 and implicit_h_s = h. BDF2 with
/// variable steps: the prediction x + s (x - x_last) + h' v, and the same for v; constraints are solved for h'.
struct TimeStep {
  double implicit_h_s;      ///< h' [s]
  double history_weight;    ///< fraction of the last substep's change that the prediction repeats
  double damping_fraction;  ///< fraction of velocity that damping removes
  double force_scale;       ///< factor of all forces: 1 for backward Euler, 1 - damping fraction for BDF2
  double kick_scale;  ///< of forces and damping, without BDF2: (1 + h_last/h)/2, the mean of both steps' lengths over h
};
/// A substep of h_s after one of last_h_s (0: none). Without BDF2: backward Euler with explicit damping. With BDF2:
/// implicit damping; backward Euler if last_h_s is 0 or less than half of h_s.
TimeStep time_step(bool uses_bdf2, double h_s, double last_h_s, double damping_per_s);

/// Whether a scene is integrated by BDF2.
FeatureDecision bdf2_decision(const Scene&, const nlohmann::json& settings);
/// Whether the links of a scene get implicit tension (xpbd/time/README.md).
FeatureDecision tension_decision(const Scene&, const nlohmann::json& settings);

/// Whether the splitting error of a scene's diagonals is corrected (xpbd/time/README.md).
FeatureDecision splitting_correction_decision(const Scene&, const nlohmann::json& settings);

/// Whether the correction suits the scene, whatever the number of substeps: a held, elastic, contact-free sheet with
/// uniform square cells and masses (xpbd/time/README.md).
FeatureDecision may_correct_splitting(const Scene&, const nlohmann::json& settings);
/// Substeps per frame that keep stretch waves and tension within the limits of the correction (rules.hpp).
double substeps_for_splitting(const Scene&);

/// True if the cloth has pinned or attached vertices.
bool is_held(const Scene&);
/// True if the scene has neither self-collision nor a collider that the cloth can reach. The motion is then the same
/// with and without its colliders. Meshes and kinematic colliders count as in reach.
bool is_contact_free(const Scene&);
/// Estimated speed [m/s] at which cloth that is not held hits static colliders: its initial speed plus the speed of a
/// fall from its centre to the nearest one. 0 if the cloth is held, no collider is in reach, or any is kinematic.
double impact_speed_m_per_s(const Scene&);

/// Substeps per frame: the setting `substeps` or, if that is 0, the rule for the setting `quality`
/// (xpbd/time/README.md). In a scene with contact it is the maximum, because the number may vary by frame.
int xpbd_substeps(const Scene&, const nlohmann::json& settings);

/// The substeps that fast motion in contact needs, if they are more than xpbd_substeps(); otherwise 0.
int uncapped_substeps_if_capped(const Scene&, const nlohmann::json& settings);

/// Substeps of a contact-free frame: as many as in the scene without colliders, or more if a kinematic collider may
/// have strained the cloth in directions that tethers do not limit.
int contact_free_substeps(const Scene&, const nlohmann::json& settings);

/// Chooses each frame's numbers of substeps and pair lists for cloth in contact with static colliders or itself
/// (xpbd/time/README.md, "By frame"): by the last frame's largest displacement and strain, and more if a link is
/// strained too far.
class SubstepController {
 public:
  SubstepController() = default;
  /// If `adapts` is false, every frame uses xpbd_substeps().
  SubstepController(const Scene&, const nlohmann::json& settings, bool adapts);
  void reset();
  bool adapts() const { return adapts_; }
  /// Substeps of a frame of the scene's duration, and their maximum.
  int substeps() const { return now_; }
  int max_substeps() const { return max_; }
  /// Number of lists of candidate pairs that such a frame builds, one after another.
  int lists() const { return lists_; }
  /// Call before each frame. `cloth_m`: largest displacement of a vertex in the last frame, scaled to the scene's frame
  /// duration; infinity: unknown. `strain`: largest of a link at its end.
  void next(double cloth_m, double strain);
  /// Call after each frame. True if the frame must be repeated with substeps(), which are now more.
  bool repeats(double strain);

 private:
  void halve_if_quiescent(double cloth_m);

  double max_strain_ = 0, repeat_strain_ = 0;
  bool adapts_ = false;
  bool is_driven_ = false;  ///< by a hand mesh
  bool is_strip_ = false;
  double cell_m_ = 0;
  int slow_ = 1, base_ = 1, max_ = 1, now_ = 1, lists_ = 1;
  int strained_ = 1;           ///< substeps that the strain of the last frames asks for; from slow_ to base_
  double attempt_strain_ = 0;  ///< of this frame's last attempt; infinity: none
  double tolerated_ = 0;  ///< strain that does not repeat a frame; above repeat_strain_ where repeating did not help
  int halvings_ = 0;      ///< how often base_ is halved now
  int quiescent_frames_ = 0;  ///< since the last halving
};

}  // namespace clothbench::pbd_gpu

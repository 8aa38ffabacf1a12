#pragma once
#include <nlohmann/json_fwd.hpp>

#include "clothbench/scene.hpp"

namespace clothbench::pbd_gpu {

/// Links along the longer side; of a mesh as many as edges of its length fit.
double links_of_longer_side(const Cloth&);

/// Substeps of a frame: setting `substeps`, or if that is 0 the rule of setting `quality` (README, "Substeps"). In a
/// scene with contact the most that a frame takes.
int xpbd_substeps(const Scene&, const nlohmann::json& settings);

/// Of a frame in which no collider can be near: those of the scene without colliders, and more where something moving
/// may have left the cloth strained in directions that tethers do not limit.
int xpbd_substeps_far(const Scene&, const nlohmann::json& settings);

/// Substeps of the same scene without gravity where gravity asks for more, else 0.
int substeps_without_gravity(const Scene&, const nlohmann::json& settings);

/// Substeps that the speed of colliders asks for, where that is more than they get: beyond, the cloth is overstretched
/// for some frames, and nothing is passed. 0 where it is not.
int substeps_over_budget(const Scene&, const nlohmann::json& settings);

/// Substeps by the way of what goes farthest in a frame.
struct WayRule {
  double way_m = 0;     ///< in a substep, where things are slow; infinity without colliders
  double faster = 1;    ///< the way of what is fast is that much shorter
  double layers_m = 0;  ///< in a substep, for layers of the cloth that touch; infinity without
  double wanted(double farthest_m) const;
};

/// Substeps of each frame of cloth that touches only itself and what stands (SUBSTEPS.md), by what went
/// farthest in the last one. What needs many of them is an impact, and most frames have none.
class Pace {
 public:
  Pace() = default;
  /// `adapts`: else every frame takes xpbd_substeps().
  Pace(const Scene&, const nlohmann::json& settings, bool adapts);
  void reset();
  bool adapts() const { return adapts_; }
  /// Of a frame as long as the scene's.
  int substeps() const { return now_; }
  /// Before a frame. `cloth_m`: the farthest way of a vertex in the last frame, in the time of a frame of the scene;
  /// infinity: unknown.
  void next(double cloth_m);

 private:
  void halve_if_calm(double cloth_m);

  WayRule rule_;
  int base_ = 1, most_ = 1, now_ = 1;
  bool adapts_ = false;
  double cell_m_ = 0;
  int halvings_ = 0;     ///< of the base
  int calm_frames_ = 0;  ///< since the last halving
};

}  // namespace clothbench::pbd_gpu

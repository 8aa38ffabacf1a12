#pragma once
#include <nlohmann/json_fwd.hpp>

#include "clothbench/scene.hpp"
#include "xpbd/lines/line_layout.hpp"

namespace clothbench::pbd_gpu {

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

/// True if pins or hands hold it.
bool is_held(const Scene&);
/// True if the scene has neither self-collision nor a collider that the cloth can reach. The motion is then the same
/// with and without its colliders. Meshes and kinematic colliders count as in reach.
bool is_contact_free(const Scene&);
/// Speed [m/s] at which a cloth that nothing holds meets static colliders: its first speed, and the speed of a fall
/// by the distance from its centre to the nearest of them. 0 if it is held or has none, or one that moves.
double impact_speed_m_per_s(const Scene&);

}  // namespace clothbench::pbd_gpu

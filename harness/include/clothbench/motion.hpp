#pragma once
#include <vector>

#include "clothbench/scene.hpp"

namespace clothbench {

/// Greatest speed [m/s] of what touches the cloth, from frame to frame: of ends of capsules, and of a skinned mesh of
/// some of its vertices. Jumps are no motion. 0 where nothing moves.
double collider_speed_m_per_s(const Scene&);

/// The same of the way to each frame from the one before, as many as `scene.motion`; 0 at the first.
std::vector<double> collider_speeds_m_per_s(const Scene&);

/// The same of vertices that hands hold, while they hold them.
double grip_speed_m_per_s(const Scene&);

}  // namespace clothbench

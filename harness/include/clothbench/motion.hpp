#pragma once
#include "clothbench/scene.hpp"

namespace clothbench {

/// Greatest speed [m/s] of what touches the cloth, from frame to frame: of ends of capsules, and of a skinned mesh of some of its
/// vertices. Jumps are no motion. 0 where nothing moves.
double collider_speed_m_per_s(const Scene&);

/// The same of vertices that hands hold, while they hold them.
double grip_speed_m_per_s(const Scene&);

}  // namespace clothbench

#pragma once
#include <vector>

#include "clothbench/scene.hpp"

namespace clothbench {

/// Maximum frame-to-frame speed [m/s] of any collider in the scene, measured at the ends of capsules and at a sample
/// of the vertices of a skinned mesh. Jumps do not count. 0 if all colliders are static.
double collider_speed_m_per_s(const Scene&);

/// As above, without the hands of users, whose speed a live session does not know beforehand.
double scripted_collider_speed_m_per_s(const Scene&);

/// Per entry of `scene.motion`: maximum speed [m/s] of colliders and attached vertices since the previous frame. The
/// first is 0.
std::vector<double> driving_speeds_m_per_s(const Scene&);

/// Maximum frame-to-frame speed [m/s] of attached vertices.
double grip_speed_m_per_s(const Scene&);

/// Maximum strain that hands impose: growth of the straight distance between the first attached vertex and another,
/// over their distance at the start, while both are attached. 0 if the hands are static or come closer.
double grip_strain(const Scene&);

}  // namespace clothbench

#pragma once
#include <vector>

#include "clothbench/scene.hpp"

namespace clothbench {

/// Greatest frame-to-frame speed [m/s] of any collider in the scene, measured at the ends of capsules and at a sample
/// of the vertices of a skinned mesh. Jumps do not count. 0 if all colliders are static.
double collider_speed_m_per_s(const Scene&);

/// The same without the hands of users, whose speed a live session does not know beforehand.
double scripted_collider_speed_m_per_s(const Scene&);

/// Greatest speed [m/s] of colliders and of vertices while they are held, since the frame before, one value per
/// `scene.motion`. The first is 0.
std::vector<double> driving_speeds_m_per_s(const Scene&);

/// Greatest frame-to-frame speed [m/s] of the gripped vertices while they are held.
double grip_speed_m_per_s(const Scene&);

/// Greatest strain that hands impose: growth of the straight distance between the first gripped vertex and another,
/// over that distance at the start, while both are held. 0 if the hands are static or come closer.
double grip_strain(const Scene&);

}  // namespace clothbench

#pragma once
#include <vector>

#include "clothbench/record.hpp"
#include "clothbench/scene.hpp"

namespace clothbench {

/// Colliders and grips of a scene at every frame, as result files store them (layout in results/README.md). A replay
/// then needs neither the scenario's assets nor this program. Empty for a scene without colliders and grips.
std::vector<StoredGroup> replay_of(const Scene&);

/// Sets the scene's colliders and grips, with their motion, from the output of `replay_of`; changes nothing else.
/// Throws Error or nlohmann::json::exception if something is missing or has another shape.
void restore_replay(const std::vector<StoredGroup>&, Scene&);

/// Adds the capsules or triangles to draw to a collider's group that has neither, for programs that do not know the
/// kinds of colliders: arrays of the same names and shapes, and whether the triangles bound a convex body. Does not
/// change groups of kinds that this version does not know. Throws as above.
void show_shape(StoredGroup&);

}  // namespace clothbench

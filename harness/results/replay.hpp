#pragma once
#include <vector>

#include "clothbench/record.hpp"
#include "clothbench/scene.hpp"

namespace clothbench {

/// Colliders and grips of a scene at every frame, as result files keep them (layout in results/README.md), so that a
/// replay needs neither the scenario's assets nor this program. Empty for a scene with neither.
std::vector<StoredGroup> replay_of(const Scene&);

/// Colliders and grips with their motion from what `replay_of` made; nothing else of the scene is touched. Throws Error
/// or nlohmann::json::exception where something is missing or of another shape.
void restore_replay(const std::vector<StoredGroup>&, Scene&);

/// Gives a collider's group that has neither capsules nor triangles the ones that it is drawn by, for programs that
/// know nothing of kinds: arrays of the same names and shapes, and whether the triangles are those of a convex body.
/// Leaves alone what this version does not know. Throws as above.
void show_shape(StoredGroup&);

}  // namespace clothbench

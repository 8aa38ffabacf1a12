#pragma once
#include <vector>

#include "clothbench/record.hpp"
#include "clothbench/scene.hpp"

namespace clothbench {

/// Colliders and grips of a scene at every frame, as result files keep them (layout in results/README.md), so that a
/// replay needs neither the scenario's assets nor this program. Empty for a scene with neither.
std::vector<StoredGroup> replay_of(const Scene&);

}  // namespace clothbench

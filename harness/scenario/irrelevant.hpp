#pragma once
#include <nlohmann/json.hpp>

#include "clothbench/feature.hpp"

namespace clothbench {

/// A scenario with every feature of `wanted` that it lacks switched on where it cannot change anything, so that what a
/// feature costs a scene that has no use for it can be timed. All of it stands in the scene like any other:
///   bend, damping   B and c of 1e-30 in their units: below the last digit of anything here
///   sphere, box, plane, capsules, static_mesh, moving_mesh
///                   one collider each, 100 m and more from the cloth (the hand on its track)
///   friction        a coefficient on those, or 1e-30 on a collider of the scene if none was added
///   double_sided    `sides` double, of cloth that had nothing to touch (single for a solver without, if it was double)
/// The others have no irrelevant form, because they change the cloth itself: stretch and shear, pins, moving pins, the
/// duplicated layer, self-collision, rendering. What was added is listed under "irrelevant"; `truth` and `expect` go,
/// as both speak of the scene as it was. Unchanged if nothing is to add. `scenario` is as written in a file, valid.
nlohmann::json with_irrelevant(nlohmann::json scenario, FeatureSet needs, FeatureSet wanted);

}  // namespace clothbench

#pragma once
#include <nlohmann/json.hpp>

#include "clothbench/feature.hpp"

namespace clothbench {

/// Switches on every feature of `wanted` that the scenario lacks, in a form that cannot change the result. This
/// measures the cost of a feature that a scene does not use. The additions are ordinary parts of the scene:
///   bend, damping   B and c of 1e-30 in SI units, below the last digit of any value here
///   sphere, box, plane, capsules, static_mesh, moving_mesh
///                   one collider each, 100 m and more from the cloth (the hand on its track)
///   friction        a coefficient on the added colliders, or 1e-30 on one of the scene if none was added
///   double_sided    `sides` double, if the scene had no colliders (single if `wanted` lacks it and it was double)
/// The others have no such form, because they change the cloth itself: stretch and shear, pins, moving pins, the
/// duplicated layer, self-collision, rendering. The key "irrelevant" lists what was added. `truth` and `expect` are
/// removed, as they describe the original scene. Unchanged if there is nothing to add. `scenario` is a valid scene.
nlohmann::json with_irrelevant(nlohmann::json scenario, FeatureSet needs, FeatureSet wanted);

}  // namespace clothbench

#pragma once
#include <nlohmann/json.hpp>
#include <string>

#include "clothbench/scene.hpp"
#include "scenario/load.hpp"

namespace clothbench {

/// Fills in `scene.colliders`, `grips`, `motion` and `assets` from the scenario. With `cloth.pose.over_table` it also
/// sets the cloth's pose and writes it back to `scenario`, for the record. All other parts of the scene must be
/// complete before the call. Throws Error with `source` and JSON pointer, or if `assets` are required and the scene
/// would use stand-ins.
void read_colliders(nlohmann::json& scenario, Scene& scene, const std::string& source, Assets assets);

}  // namespace clothbench

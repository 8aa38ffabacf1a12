#pragma once
#include <nlohmann/json.hpp>
#include <string>

#include "clothbench/scene.hpp"
#include "scenario/load.hpp"

namespace clothbench {

/// Fills in `scene.colliders`, `grips`, `motion` and `assets` from the scenario, and, where `cloth.pose.over_table`
/// asks for it, the cloth's pose, which is written back to `scenario` for the record. Everything of the scene that
/// does not move must be there already. Throws Error with `source` and JSON pointer, or if `assets` are required and
/// those in use are stand-ins.
void read_colliders(nlohmann::json& scenario, Scene& scene, const std::string& source, Assets assets);

}  // namespace clothbench

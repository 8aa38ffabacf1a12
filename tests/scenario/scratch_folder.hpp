#pragma once
#include <nlohmann/json.hpp>

#include "refusal.hpp"
#include "with_folder.hpp"

namespace clothbench {

/// A scene whose cloth is a mesh.
inline nlohmann::json mesh_scenario(nlohmann::json mesh) {
  return {{"name", "mesh"},
          {"why", "a mesh for the tests"},
          {"cloth", {{"mesh", std::move(mesh)}, {"areal_density_kg_per_m2", 0.3}, {"sides", "single"}}},
          {"material", {{"membrane_stiffness_N_per_m", 1000}}},
          {"time", {{"frame_rate_hz", 60}, {"duration_s", 0.5}}}};
}

}  // namespace clothbench

#pragma once
#include <nlohmann/json_fwd.hpp>
#include <string>

#include "clothbench/scene.hpp"

namespace clothbench {

/// Reads the parts of a completed scenario for uneven cells, masses or stiffness and for a start away from rest:
/// cloth.column_factors, .mass_factors, .start, .spin_rad_per_s and material.regions. Throws Error with JSON pointer.
void read_irregular(const nlohmann::json& scenario, Scene&, const std::string& source);

/// Reads time.hitch and time.jitter into the end times of frames. `scene.time` must have its rate and duration.
void read_frame_times(const nlohmann::json& time, Scene&, const std::string& source);

/// Reads the `stability` block.
void read_stability(const nlohmann::json& scenario, Scene&);

}  // namespace clothbench

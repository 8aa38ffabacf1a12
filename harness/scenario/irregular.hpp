#pragma once
#include <nlohmann/json_fwd.hpp>
#include <string>

#include "clothbench/scene.hpp"

namespace clothbench {

/// The parts of a completed scenario that make a sheet uneven, heavy in places, or start where it does not rest:
/// cloth.column_factors, .mass_factors, .start, .spin_rad_per_s and material.regions. Throws Error with JSON pointer.
void read_irregular(const nlohmann::json& scenario, Scene&, const std::string& source);

/// time.hitch and time.jitter: where frames end. `scene.time` has its rate and duration.
void read_frame_times(const nlohmann::json& time, Scene&, const std::string& source);

/// The `stability` block.
void read_stability(const nlohmann::json& scenario, Scene&);

}  // namespace clothbench

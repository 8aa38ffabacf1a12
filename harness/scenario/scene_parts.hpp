#pragma once
#include <functional>
#include <memory>
#include <nlohmann/json.hpp>
#include <nlohmann/json_fwd.hpp>
#include <string>

#include "clothbench/scene.hpp"
#include "scenario/load.hpp"

namespace clothbench {

/// Where the parts of a scene come from that its JSON only names: a mesh file, and colliders and grips with their
/// motion, which need rooms and hands.
struct SceneParts {
  /// From the value of `cloth.mesh`; not called for a grid.
  std::function<std::shared_ptr<const ClothMesh>(nlohmann::json&)> mesh;
  /// Fills in `colliders`, `grips`, `motion`, `jumps` and `assets` of a scene that has everything else but `expect`.
  std::function<void(nlohmann::json& scenario, Scene&)> colliders;
};

/// As scene_from_json of load.hpp, with other parts than the files and assets that the scene names.
Scene scene_from_parts(nlohmann::json scenario, const std::string& source, const SceneParts&);

/// Fills in `scene.colliders`, `grips`, `motion` and `assets` from the scenario. With `cloth.pose.over_table` it also
/// sets the cloth's pose and writes it back to `scenario`, for the record. All other parts of the scene must be
/// complete before the call. Throws Error with `source` and JSON pointer, or if `assets` are required and the scene
/// would use stand-ins.
void read_colliders(nlohmann::json& scenario, Scene& scene, const std::string& source, Assets assets);

/// Reads the parts of a completed scenario for uneven cells, masses or stiffness and for a start away from rest:
/// cloth.column_factors, .mass_factors, .start, .spin_rad_per_s and material.regions. Throws Error with JSON pointer.
void read_irregular(const nlohmann::json& scenario, Scene&, const std::string& source);

/// Reads time.hitch and time.jitter into the end times of frames. `scene.time` must have its rate and duration.
void read_frame_times(const nlohmann::json& time, Scene&, const std::string& source);

/// Reads the `stability` block.
void read_stability(const nlohmann::json& scenario, Scene&);

// Text of scenarios/schema/*.schema.json, compiled in.
extern const char* const kSceneSchema;
extern const char* const kStudySchema;

}  // namespace clothbench

#pragma once
#include <filesystem>
#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "base/json_text.hpp"
#include "clothbench/error.hpp"
#include "clothbench/scene.hpp"

namespace clothbench {

/// Folder of the scenario files (kScenarioFolder). Throws Error if there is none.
std::filesystem::path scenario_root();

/// The file `name_or_path`, or `<scenario_root>/<name>.json` or studies/<name>.json there. Throws Error if none exists.
std::filesystem::path find_scenario(const std::string& name_or_path);

/// Names, as used in commands, of the scene files below these folders of the scenarios.
std::vector<std::string> scene_names(const std::vector<std::string>& folders);

/// Whether procedural stand-ins may replace missing rooms and hands.
enum class Assets { MayBeProcedural, Required };

/// Loads, checks and completes a scene. `overrides` are `dotted.key=JSON` as for `--set`. Throws Error with file, JSON
/// pointer (or line and column) and what was expected; with Assets::Required also if a room or hand of the scene is
/// missing.
Scene load_scene(const std::string& name_or_path, const std::vector<std::string>& overrides = {},
                 Assets assets = Assets::MayBeProcedural);

/// load_scene for parsed JSON; `source` is its name in messages.
Scene scene_from_json(nlohmann::json scenario, const std::string& source,
                      const std::vector<std::string>& overrides = {}, Assets assets = Assets::MayBeProcedural);

/// Sets `dotted.key` to a JSON value (a bare word counts as a string). The key's parent must exist or be an object of
/// the scene format. A number is an index into a list (colliders.0.friction). The caller validates the result.
void apply_override(nlohmann::json& scenario, const std::string& assignment, const std::string& source);

/// Multiplies all lengths of a scene by `length` and all times by `time`: each number by the powers that the unit at
/// the end of its key has. Masses per area stay.
void scale_units(nlohmann::json& scenario, double length, double time);

/// Converts a JSON array of three numbers, already validated by the schema.
inline Vec3 vec3(const nlohmann::json& j) { return {j[0].get<double>(), j[1].get<double>(), j[2].get<double>()}; }

/// The features that a solver needs for the scene.
FeatureSet derive_needs(const Scene&);

/// Whether penetration depth is defined for a collider: for all shapes except meshes (a plane's inside is the
/// half-space behind it), for closed meshes with outward normals, and for skinned meshes, which are hands open only at
/// the wrist. Rooms have no inside.
bool has_inside(const Collider&);

/// One bound of the strict set: no cloth passes through anything, and the cloth stays intact.
struct StrictBound {
  const char* scalar;
  double at_most;
  bool (*defined)(const Scene&);  ///< whether the scalar applies to the scene
};

/// The strict set. The limits come from scenarios/README.md, "Strict contact".
const std::vector<StrictBound>& strict_contact();

/// Replaces `"contact": "strict"` in a scene's `expect` by those bounds of the strict set that apply to the scene. A
/// bound that the scene states stays. Throws Error with `source` and JSON pointer if such a bound is looser than the
/// set's and states no reason ("why"), or if the scene has nothing to touch or hold.
void complete_expect(nlohmann::json& expect, const Scene&, const std::string& source);

/// Sources of the parts that a scene's JSON only names: a mesh file, and colliders and grips with their motion, which
/// need rooms and hands.
struct SceneParts {
  /// Reads the value of `cloth.mesh`; not called for a grid.
  std::function<std::shared_ptr<const ClothMesh>(nlohmann::json&)> mesh;
  /// Fills in `colliders`, `grips`, `motion`, `jumps` and `assets` of a scene that is complete except for `expect`.
  std::function<void(nlohmann::json& scenario, Scene&)> colliders;
};

/// As scene_from_json, but with these parts instead of the files and assets that the scene names.
Scene scene_from_parts(nlohmann::json scenario, const std::string& source, const SceneParts&);

/// Fills in `scene.colliders`, `grips`, `motion` and `assets` from the scenario. With `cloth.pose.over_table` it also
/// sets the cloth's pose and writes it back to `scenario` for the record. All other parts of the scene must be
/// complete. Throws Error with `source` and JSON pointer, also if `assets` are required and the scene would use
/// stand-ins.
void read_colliders(nlohmann::json& scenario, Scene& scene, const std::string& source, Assets assets);

/// Reads uneven cells, masses and stiffness, and a start not at rest, from a completed scenario: cloth.column_factors,
/// .mass_factors, .start, .spin_rad_per_s and material.regions. Throws Error with JSON pointer.
void read_irregular(const nlohmann::json& scenario, Scene&, const std::string& source);

/// Converts time.hitch and time.jitter into end times of frames. `scene.time` must have its rate and duration.
void read_frame_times(const nlohmann::json& time, Scene&, const std::string& source);

/// Reads the `stability` block.
void read_stability(const nlohmann::json& scenario, Scene&);

// Text of scenarios/schema/*.schema.json, compiled in.
extern const char* const kSceneSchema;
extern const char* const kStudySchema;

}  // namespace clothbench

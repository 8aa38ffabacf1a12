#pragma once
#include <filesystem>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "clothbench/error.hpp"
#include "clothbench/scene.hpp"

namespace clothbench {

/// Folder with the scenario files (kScenarioFolder). Throws Error if there is none.
std::filesystem::path scenario_root();

/// `name_or_path` as given, or `<scenario_root>/<name>.json`. Throws Error if there is neither.
std::filesystem::path find_scenario(const std::string& name_or_path);

/// May stand-ins take the place of rooms and hands that have not been fetched?
enum class Assets { MayBeProcedural, Required };

/// Loads, checks and completes a scene. `overrides` are `dotted.key=JSON` as `--set` takes them. Throws Error: one
/// message with file, JSON pointer (or line and column) and what was expected; or, with Assets::Required, that a room
/// or hand the scene uses is not there.
Scene load_scene(const std::string& name_or_path, const std::vector<std::string>& overrides = {},
                 Assets assets = Assets::MayBeProcedural);

/// The same from parsed JSON; `source` stands in messages.
Scene scene_from_json(nlohmann::json scenario, const std::string& source,
                      const std::vector<std::string>& overrides = {}, Assets assets = Assets::MayBeProcedural);

/// Sets `dotted.key` to a JSON value (a bare word counts as a string). The key's parent must exist or be an object of
/// the scene format; a number goes into a list (colliders.0.friction). The result is validated afterwards.
void apply_override(nlohmann::json& scenario, const std::string& assignment, const std::string& source);

/// What the scene asks of a solver.
FeatureSet derive_needs(const Scene&);

}  // namespace clothbench

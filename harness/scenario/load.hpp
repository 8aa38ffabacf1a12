#pragma once
#include <filesystem>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "clothbench/error.hpp"
#include "clothbench/scene.hpp"

namespace clothbench {

/// Folder of the scenario files (kScenarioFolder). Throws Error if there is none.
std::filesystem::path scenario_root();

/// The file `name_or_path`, else `<scenario_root>/<name>.json` or its studies/<name>.json. Throws Error if none exists.
std::filesystem::path find_scenario(const std::string& name_or_path);

/// Scene files below these folders of the scenarios, as commands name them.
std::vector<std::string> scene_names(const std::vector<std::string>& folders);

/// Whether procedural stand-ins may replace rooms and hands that have not been fetched.
enum class Assets { MayBeProcedural, Required };

/// Loads, checks and completes a scene. `overrides` are `dotted.key=JSON` as for `--set`. Throws Error with file, JSON
/// pointer (or line and column) and what was expected; with Assets::Required also if a room or hand of the scene is
/// missing.
Scene load_scene(const std::string& name_or_path, const std::vector<std::string>& overrides = {},
                 Assets assets = Assets::MayBeProcedural);

/// The same from parsed JSON; `source` names it in messages.
Scene scene_from_json(nlohmann::json scenario, const std::string& source,
                      const std::vector<std::string>& overrides = {}, Assets assets = Assets::MayBeProcedural);

/// Sets `dotted.key` to a JSON value (a bare word counts as a string). The key's parent must exist or be an object of
/// the scene format. A number is an index into a list (colliders.0.friction). The caller validates the result.
void apply_override(nlohmann::json& scenario, const std::string& assignment, const std::string& source);

/// The features that a solver needs to run the scene.
FeatureSet derive_needs(const Scene&);

}  // namespace clothbench

#pragma once
#include <functional>
#include <memory>
#include <nlohmann/json.hpp>
#include <string>

#include "clothbench/scene.hpp"

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

}  // namespace clothbench

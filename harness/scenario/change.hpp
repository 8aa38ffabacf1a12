#pragma once
#include <cstdint>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "clothbench/scene.hpp"

namespace clothbench {

/// A change of position, orientation and units of length and time of a whole scene. The solution must change in the
/// same way. Lengths are multiplied by `length`, times by `time`; then x -> turn x + offset_m. So g scales with
/// length/time^2, areal density with 1/length^2, membrane stiffness with 1/time^2, bending rigidity with
/// length^2/time^2, velocities with length/time, rates with 1/time.
struct SceneChange {
  std::array<Vec3, 3> turn{{{1, 0, 0}, {0, 1, 0}, {0, 0, 1}}};  ///< rows of a rotation matrix
  Vec3 offset_m{};
  double length = 1, time = 1;

  Vec3 turned(const Vec3&) const;
};

/// Applies the change to a scene as scene_from_json completes it. Throws Error with `source` for an unsupported scene:
/// one with hands, rooms or irregular parts.
nlohmann::json change_scene(nlohmann::json scenario, const SceneChange&, const std::string& source);

}  // namespace clothbench

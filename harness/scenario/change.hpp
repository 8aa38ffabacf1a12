#pragma once
#include <cstdint>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "clothbench/scene.hpp"

namespace clothbench {

/// A change of position, orientation and units of length, time and mass of a whole scene. The solution must change in
/// the same way. Lengths are multiplied by `length`, times by `time`, masses by `mass`; then x -> turn x + offset_m. So
/// g scales with length/time^2, areal density with mass/length^2, membrane stiffness with mass/time^2, bending rigidity
/// with mass length^2/time^2, velocities with length/time, rates with 1/time.
struct SceneChange {
  std::array<Vec3, 3> turn{{{1, 0, 0}, {0, 1, 0}, {0, 0, 1}}};  ///< rows of an orthogonal matrix; may reflect
  Vec3 offset_m{};
  double length = 1, time = 1, mass = 1;

  Vec3 turned(const Vec3&) const;
  bool mirrors() const;
};

/// Applies the change to a scene as scene_from_json completes it. Throws Error with `source` for an unsupported scene:
/// one with hands, rooms or irregular parts, or the reflection of a sheet that does not start flat.
nlohmann::json change_scene(nlohmann::json scenario, const SceneChange&, const std::string& source);

enum class Renumbering { FlipU, FlipV, Transpose };

/// The same cloth with other vertex numbers, for flat sheets without hands or rooms. `new_to_old[k]` is the old number
/// of the new vertex k.
nlohmann::json renumber_scene(nlohmann::json scenario, Renumbering, const std::string& source,
                              std::vector<std::uint32_t>& new_to_old);

}  // namespace clothbench

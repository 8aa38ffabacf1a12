#pragma once
#include <cstdint>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "clothbench/scene.hpp"

namespace clothbench {

/// Another place, orientation and unit of length, time and mass for a whole scene: what its answer must follow. Lengths
/// are multiplied by `length`, times by `time`, masses by `mass`; then x -> turn x + offset_m. So g goes with
/// length/time^2, areal density with mass/length^2, membrane stiffness with mass/time^2, bending rigidity with mass
/// length^2/time^2, velocities with length/time, rates with 1/time.
struct SceneChange {
  std::array<Vec3, 3> turn{{{1, 0, 0}, {0, 1, 0}, {0, 0, 1}}};  ///< rows of an orthogonal matrix; a reflection too
  Vec3 offset_m{};
  double length = 1, time = 1, mass = 1;

  Vec3 turned(const Vec3&) const;
  bool mirrors() const;
};

/// A scene as scene_from_json completes it, changed. Throws Error with `source` for what cannot be: hands and rooms,
/// and reflections of a sheet that does not start flat.
nlohmann::json change_scene(nlohmann::json scenario, const SceneChange&, const std::string& source);

enum class Renumbering { FlipU, FlipV, Transpose };

/// The same cloth with its vertices numbered otherwise; flat sheets without hands or rooms. `new_to_old[k]` is the old
/// number of the new vertex k.
nlohmann::json renumber_scene(nlohmann::json scenario, Renumbering, const std::string& source,
                              std::vector<std::uint32_t>& new_to_old);

}  // namespace clothbench

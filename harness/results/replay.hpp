#pragma once
#include <filesystem>
#include <vector>

#include "clothbench/record.hpp"
#include "clothbench/scene.hpp"

namespace clothbench {

/// The parts of a scene that its JSON only names, as result files store them (layout in results/README.md): colliders
/// and grips at every frame, and a cloth's mesh. A replay then needs neither the scenario's files nor this program.
/// Empty for a grid without colliders and grips.
std::vector<StoredGroup> replay_of(const Scene&);

/// Adds the capsules or triangles to draw to a collider's group that has neither, for programs that do not know the
/// kinds of colliders: arrays of the same names and shapes, and whether the triangles bound a convex body. Does not
/// change groups of kinds that this version does not know. Throws Error or nlohmann::json::exception if something is
/// missing or has another shape.
void show_shape(StoredGroup&);

/// A stored run's scene and motion, read only from its result file.
struct StoredMotion {
  Scene scene;                  ///< complete: cloth, pins, colliders and grips with their motion
  std::vector<double> time_s;   ///< of each stored frame; frame 0 is the initial state
  std::vector<float> position;  ///< (frame, vertex, xyz) [m], time_s.size() x vertex_count() x 3 values
  /// Distance [m] at which the solver kept the cloth from each collider. Empty: `margin_m` of the colliders.
  std::vector<double> contact_margins_m;
};

/// Reads a result file; opens no other file. All is empty if the run has no trajectory.
/// Throws Error naming the file and what is wrong with it, such as a number of positions that differs from the scene.
StoredMotion read_motion(const std::filesystem::path&);

}  // namespace clothbench

#pragma once
#include <filesystem>
#include <vector>

#include "clothbench/scene.hpp"

namespace clothbench {

/// A stored run's scene and motion, from its result file alone.
struct StoredMotion {
  Scene scene;                  ///< complete: cloth, pins, colliders and grips with their motion
  std::vector<double> time_s;   ///< of each stored frame; frame 0 is the initial state
  std::vector<float> position;  ///< (frame, vertex, xyz) [m], time_s.size() x vertex_count() x 3 values
  /// Distance [m] at which the solver kept the cloth from each collider. Empty: `margin_m` of the colliders.
  std::vector<double> contact_margins_m;
};

/// Reads a result file (.h5) or a part folder; opens no other file. All is empty if the run has no trajectory.
/// Throws Error naming the file and what is wrong with it, such as a number of positions that is not that of the scene.
StoredMotion read_motion(const std::filesystem::path&);

}  // namespace clothbench

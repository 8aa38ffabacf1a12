#pragma once
#include <filesystem>
#include <string>
#include <vector>

#include "clothbench/record.hpp"
#include "clothbench/scene.hpp"

namespace clothbench::render {

/// Input of pictures: the trajectory of a cloth, and the colliders that it touches.
struct Motion {
  Scene scene;
  bool held = false;    ///< pinned, gripped or with colliders: the cloth stays near its initial place
  std::string name;     ///< of the run, for file names
  std::string title;    ///< for display: "hang · xpbd"
  std::string outcome;  ///< how the run ended, "" if well
  std::vector<double> time_s;
  std::vector<float> position;  ///< (frame, vertex, xyz) [m]

  std::size_t frames() const { return time_s.size(); }
  /// Positions at one frame, xyz interleaved.
  std::vector<double> at(std::size_t frame) const;
};

/// Reads a result file (.h5) or the part folder of a run without HDF5. No frames if it has no trajectory. Throws Error
/// naming the file and what is wrong with it.
Motion stored_motion(const std::filesystem::path&);

/// The motion of a run that has just finished.
Motion motion_of(const Scene&, const RunHeader&, const Outcome&, AccuracyPass);

}  // namespace clothbench::render

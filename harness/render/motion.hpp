#pragma once
#include <filesystem>
#include <string>
#include <vector>

#include "clothbench/record.hpp"
#include "clothbench/scene.hpp"

namespace clothbench::render {

/// What pictures are made of: a cloth's way, and what it touches.
struct Motion {
  Scene scene;        ///< of one read from a file: grid and sizes of the cloth, colliders and grips with their motion,
                      ///< nothing else
  bool held = false;  ///< pinned or gripped somewhere, or there are colliders: it stays where it is looked for
  std::string name;   ///< of the run, for files
  std::string title;  ///< for people: "hang · xpbd"
  std::string outcome;  ///< how the run ended, "" if well
  std::vector<double> time_s;
  std::vector<float> position;  ///< (frame, vertex, xyz) [m]

  std::size_t frames() const { return time_s.size(); }
  /// Positions at one frame, xyz interleaved.
  std::vector<double> at(std::size_t frame) const;
};

/// From a result file (.h5) or the part folder of a run without HDF5. No frames where it has no trajectory. Throws
/// Error naming the file and what is wrong with it.
Motion stored_motion(const std::filesystem::path&);

/// Of a run that has just finished.
Motion motion_of(const Scene&, const RunHeader&, const Outcome&, AccuracyPass);

}  // namespace clothbench::render

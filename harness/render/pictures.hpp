#pragma once
#include <filesystem>
#include <functional>
#include <string>
#include <vector>

#include "render/offscreen.hpp"

namespace clothbench::render {

/// Input for images: the trajectory of a cloth, and the scene with its colliders.
struct Motion {
  Scene scene;
  std::string name;  ///< name of the run; names of files begin with it
  std::vector<double> time_s;
  std::vector<float> position;  ///< (frame, vertex, xyz) [m]

  std::size_t frames() const { return time_s.size(); }
  /// Positions at one frame, xyz interleaved.
  std::vector<double> at(std::size_t frame) const;
};

/// Reads a result file. Throws Error naming the file and its fault, such as a missing trajectory.
Motion stored_motion(const std::filesystem::path&);

/// Common view of all images of a motion, for one camera: a box around the cloth of all frames, without vertices that
/// are not finite or are farther from the initial bounds than the cloth's size.
struct Framing {
  Bounds near;                 ///< around the cloth, with a margin; colliders are clipped to it
  Vec3 origin_m{};             ///< centre of the cloth's bounds
  std::vector<double> points;  ///< corners of the box that must be in the picture, xyz interleaved [m]
  bool follows = false;        ///< the camera follows the cloth's middle vertex, for free cloth
};
Framing framing_of(const Motion&);

/// Options of the pictures of a motion.
struct Shots {
  int width = 1200, height = 900;   ///< of a picture [pixels]
  bool movie = true;                ///< also write an MP4 if there is more than one frame and ffmpeg is installed
  std::vector<std::size_t> frames;  ///< ascending
  std::filesystem::path out;        ///< folder
};

struct Taken {
  std::vector<std::filesystem::path> pictures;
  std::filesystem::path movie;  ///< empty: none
  std::string no_movie;         ///< why there is no movie although one was requested
};

/// Renders the motion at the requested frames, <name>__<frame>.png. `progress` (may be empty) gets the number of images
/// so far. Throws Error for a frame that the motion does not have, a file that cannot be written, or a missing device.
Taken take(const Motion&, const Shots&, const DeviceOptions&,
           const std::function<void(const std::string&, std::size_t, std::size_t)>& progress = {});

/// List of the written files for the terminal; many images become one line.
std::string taken_text(const Taken&);

/// Frame numbers from "12", "0:71" or "0:-1:4" (first and last, both included, and step; -1 is the last frame; in
/// ":71" and "12:" the first and the last frame are implied). Throws Error with --frames and the expected form.
std::vector<std::size_t> frames_from(const std::string& text, std::size_t count);

/// Writes under a temporary name, then renames. Throws Error naming the file.
void write_png(const std::filesystem::path&, const Picture&);

}  // namespace clothbench::render

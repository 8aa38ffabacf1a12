#pragma once
#include <functional>

#include "clothbench/solver.hpp"
#include "render/colours.hpp"
#include "render/framing.hpp"
#include "render/motion.hpp"
#include "render/picture.hpp"

namespace clothbench::render {

/// Options of the pictures of a motion.
struct Shots {
  std::vector<View> views = {View::Corner};
  Colour colour = Colour::Checker;
  int width = 1200, height = 900;   ///< of a picture, with legend and caption [pixels]
  bool plain = false;               ///< no legend, no caption
  bool movie = true;                ///< also write an MP4 if there is more than one frame and ffmpeg is installed
  std::vector<std::size_t> frames;  ///< ascending
  std::filesystem::path out;        ///< folder
};

struct Taken {
  std::vector<std::filesystem::path> pictures, movies;
  std::string no_movie;  ///< why there is no movie although one was requested
};

/// Draws the motion at the requested frames, <name>__<view>__<colour>__<frame>.png; all pictures of a view have the
/// same camera and scale. `progress` (may be empty) gets the share done. Throws Error on a frame that the motion does
/// not have, a picture too small for its legend, a file that cannot be written, or a missing device.
Taken take(const Motion&, const Shots&, const DeviceOptions&,
           const std::function<void(const std::string&, std::size_t, std::size_t)>& progress = {});

/// What was written, for the terminal; many pictures are one line.
std::string taken_text(const Taken&);

/// Frame numbers from "12", "0:71" or "0:-1:4" (first and last, both included, and step; -1 is the last frame; an
/// empty end is the first or the last frame). Throws Error naming --frames and the expected form.
std::vector<std::size_t> frames_from(const std::string& text, std::size_t count);

}  // namespace clothbench::render

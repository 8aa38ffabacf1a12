#pragma once
#include <functional>

#include "clothbench/solver.hpp"
#include "render/colours.hpp"
#include "render/framing.hpp"
#include "render/motion.hpp"
#include "render/picture.hpp"

namespace clothbench::render {

/// How a motion is to be shown.
struct Shots {
  std::vector<View> views = {View::Corner};
  Colour colour = Colour::Checker;
  int width = 1200, height = 900;   ///< of a picture, legend and caption included [pixels]
  bool plain = false;               ///< no legend, no caption
  bool movie = true;                ///< also an MP4 of more than one frame, where ffmpeg is present
  std::vector<std::size_t> frames;  ///< ascending
  std::filesystem::path out;        ///< folder
};

struct Taken {
  std::vector<std::filesystem::path> pictures, movies;
  std::string no_movie;  ///< why there is none though one was wanted
};

/// Pictures of the motion at the frames asked for, <name>__<view>__<colour>__<frame>.png, all of a view from one camera
/// and with one scale. `progress` (may be empty) gets how much is done. Throws Error on a frame it does not
/// have, a picture too small for its legend, a file that cannot be written, or a missing device.
Taken take(const Motion&, const Shots&, const DeviceOptions&,
           const std::function<void(const std::string&, std::size_t, std::size_t)>& progress = {});

/// "12", "0:71", "0:-1:4" (first, last, both included, step; -1 is the last there is; empty ends are the first and the
/// last) as numbers of frames. Throws Error naming --frames and what was expected.
std::vector<std::size_t> frames_from(const std::string& text, std::size_t count);

}  // namespace clothbench::render

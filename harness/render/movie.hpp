#pragma once
#include <filesystem>

#include "base/child_process.hpp"
#include "render/picture.hpp"

namespace clothbench::render {

/// Pictures of one size into an MP4 (H.264), by the program ffmpeg.
class Movie {
 public:
  /// Is ffmpeg on the PATH?
  static bool possible();

  /// Throws Error if ffmpeg cannot be started.
  Movie(std::filesystem::path file, int width, int height, double frames_per_s);
  /// Waits for ffmpeg, whose file of the pictures so far is whole then.
  ~Movie();
  Movie(const Movie&) = delete;
  Movie& operator=(const Movie&) = delete;

  /// Throws Error once ffmpeg takes no more.
  void add(const Picture&);
  /// Waits for the file to be whole. Throws Error with what ffmpeg had to say.
  void finish();

 private:
  ChildEnd end();

  std::filesystem::path file_, log_;
  ChildProcess ffmpeg_;
};

}  // namespace clothbench::render

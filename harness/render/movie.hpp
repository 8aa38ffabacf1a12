#pragma once
#include <filesystem>

#include "base/child_process.hpp"
#include "render/picture.hpp"

namespace clothbench::render {

/// Writes pictures of one size into an MP4 (H.264) with the program ffmpeg.
class Movie {
 public:
  /// Is ffmpeg on the PATH?
  static bool possible();

  /// Throws Error if ffmpeg cannot be started.
  Movie(std::filesystem::path file, int width, int height, double frames_per_s);
  /// Waits for ffmpeg, which completes the file with the pictures so far.
  ~Movie();
  Movie(const Movie&) = delete;
  Movie& operator=(const Movie&) = delete;

  /// Throws Error if ffmpeg no longer accepts input.
  void add(const Picture&);
  /// Waits until the file is complete. Throws Error with ffmpeg's messages.
  void finish();

 private:
  ChildEnd end();

  std::filesystem::path file_, log_;
  ChildProcess ffmpeg_;
};

}  // namespace clothbench::render

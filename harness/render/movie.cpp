#include "render/movie.hpp"

#include <fmt/format.h>
#include <unistd.h>

#include <cstdlib>
#include <sstream>
#include <vector>

#include "base/files.hpp"
#include "clothbench/error.hpp"

namespace clothbench::render {
namespace {

// H.264 with quarter resolution colour, which every player shows, wants even sizes.
std::vector<std::string> words(const std::filesystem::path& file, int width, int height, double frames_per_s) {
  return {"ffmpeg",     "-loglevel",
          "error",      "-y",
          "-f",         "rawvideo",
          "-pix_fmt",   "rgb24",
          "-s",         fmt::format("{}x{}", width, height),
          "-r",         fmt::format("{:.6g}", frames_per_s),
          "-i",         "pipe:0",
          "-vf",        "pad=ceil(iw/2)*2:ceil(ih/2)*2:color=white",
          "-c:v",       "libx264",
          "-crf",       "18",
          "-pix_fmt",   "yuv420p",
          "-movflags",  "+faststart",
          "-f",         "mp4",
          file.string()};
}

}  // namespace

bool Movie::possible() {
  const char* path = std::getenv("PATH");
  std::istringstream folders(path != nullptr ? path : "");
  for (std::string folder; std::getline(folders, folder, ':');)
    if (access((std::filesystem::path(folder.empty() ? "." : folder) / "ffmpeg").c_str(), X_OK) == 0) return true;
  return false;
}

Movie::Movie(std::filesystem::path file, int width, int height, double frames_per_s)
    : file_(std::move(file)),
      log_(file_.string() + ".log"),
      ffmpeg_(words(file_, width, height, frames_per_s), {.socket = true, .out = "/dev/null", .err = log_}) {}

Movie::~Movie() { end(); }

ChildEnd Movie::end() {
  ffmpeg_.close_socket();
  return ffmpeg_.wait();
}

void Movie::add(const Picture& picture) {
  if (ffmpeg_.write({reinterpret_cast<const char*>(picture.rgb.data()), picture.rgb.size()})) return;
  finish();  // says why, if it knows
  throw Error(file_.string() + ": ffmpeg ended too early");
}

void Movie::finish() {
  const ChildEnd how = end();
  const std::string said = content_of(log_);
  std::error_code ignored;
  std::filesystem::remove(log_, ignored);
  if (how.how == ChildEnd::How::Exited && how.code == 0) return;
  throw Error(file_.string() + ": ffmpeg failed: " + said);
}

}  // namespace clothbench::render

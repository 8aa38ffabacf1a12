#include "render/movie.hpp"

#include <fcntl.h>
#include <fmt/format.h>
#include <spawn.h>
#include <sys/socket.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cerrno>
#include <cstdlib>
#include <cstring>
#include <fstream>
#include <sstream>
#include <vector>

#include "clothbench/error.hpp"

extern char** environ;

namespace clothbench::render {

bool Movie::possible() {
  const char* path = std::getenv("PATH");
  std::istringstream folders(path != nullptr ? path : "");
  for (std::string folder; std::getline(folders, folder, ':');)
    if (access((std::filesystem::path(folder.empty() ? "." : folder) / "ffmpeg").c_str(), X_OK) == 0) return true;
  return false;
}

Movie::Movie(std::filesystem::path file, int width, int height, double frames_per_s)
    : file_(std::move(file)), log_(file_.string() + ".log") {
  // A socket, not a pipe: writing to a program that has ended is then an error instead of a signal.
  int ends[2];
  if (socketpair(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC, 0, ends) != 0)
    throw Error(std::string("socketpair: ") + std::strerror(errno));
  posix_spawn_file_actions_t actions;
  posix_spawn_file_actions_init(&actions);
  posix_spawn_file_actions_adddup2(&actions, ends[1], STDIN_FILENO);
  posix_spawn_file_actions_addopen(&actions, STDERR_FILENO, log_.c_str(), O_WRONLY | O_CREAT | O_TRUNC, 0644);
  posix_spawn_file_actions_addopen(&actions, STDOUT_FILENO, "/dev/null", O_WRONLY, 0);
  // H.264 with quarter resolution colour, which every player shows, wants even sizes.
  const std::vector<std::string> words = {"ffmpeg",      "-loglevel",
                                          "error",       "-y",
                                          "-f",          "rawvideo",
                                          "-pix_fmt",    "rgb24",
                                          "-s",          fmt::format("{}x{}", width, height),
                                          "-r",          fmt::format("{:.6g}", frames_per_s),
                                          "-i",          "pipe:0",
                                          "-vf",         "pad=ceil(iw/2)*2:ceil(ih/2)*2:color=white",
                                          "-c:v",        "libx264",
                                          "-crf",        "18",
                                          "-pix_fmt",    "yuv420p",
                                          "-movflags",   "+faststart",
                                          "-f",          "mp4",
                                          file_.string()};
  std::vector<char*> argv;
  for (const std::string& w : words) argv.push_back(const_cast<char*>(w.c_str()));
  argv.push_back(nullptr);
  const int failed = posix_spawnp(&pid_, "ffmpeg", &actions, nullptr, argv.data(), environ);
  posix_spawn_file_actions_destroy(&actions);
  close(ends[1]);
  to_ffmpeg_ = ends[0];
  if (failed == 0) return;
  close(to_ffmpeg_);
  throw Error(std::string("ffmpeg: ") + std::strerror(failed));
}

Movie::~Movie() {
  if (pid_ > 0) reap();
}

int Movie::reap() {
  close(to_ffmpeg_);
  int status = 0;
  while (waitpid(pid_, &status, 0) < 0 && errno == EINTR) {
  }
  pid_ = -1;
  return status;
}

void Movie::add(const Picture& picture) {
  const auto* from = reinterpret_cast<const char*>(picture.rgb.data());
  for (std::size_t left = picture.rgb.size(); left > 0;) {
    const ssize_t sent = send(to_ffmpeg_, from, left, MSG_NOSIGNAL);
    if (sent < 0 && errno == EINTR) continue;
    if (sent <= 0) {
      finish();  // says why, if it knows
      throw Error(file_.string() + ": ffmpeg ended too early");
    }
    from += sent;
    left -= static_cast<std::size_t>(sent);
  }
}

void Movie::finish() {
  const int status = reap();
  std::stringstream said;
  said << std::ifstream(log_).rdbuf();
  std::error_code ignored;
  std::filesystem::remove(log_, ignored);
  if (WIFEXITED(status) && WEXITSTATUS(status) == 0) return;
  throw Error(file_.string() + ": ffmpeg failed: " + said.str());
}

}  // namespace clothbench::render

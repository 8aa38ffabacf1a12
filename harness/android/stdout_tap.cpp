#include "android/stdout_tap.hpp"

#include <unistd.h>

#include <chrono>
#include <cstdio>
#include <thread>

#include "clothbench/error.hpp"

namespace clothbench::android {
namespace {

/// A line of its own that no command prints: everything before it has come through.
constexpr char kMark = '\x1e';

}  // namespace

StdoutTap::StdoutTap(std::function<void(const std::string&)> line) : line_(std::move(line)) {
  int ends[2];
  if (pipe(ends) != 0 || dup2(ends[1], STDOUT_FILENO) < 0 || dup2(ends[1], STDERR_FILENO) < 0)
    throw Error("stdout cannot be sent to the log", ExitCode::CheckFailed);
  close(ends[1]);
  read_end_ = ends[0];
  std::setvbuf(stdout, nullptr, _IOLBF, 0);
  std::thread([this] { read_all(); }).detach();
}

void StdoutTap::read_all() {
  std::string rest;
  char chunk[4096];
  for (;;) {
    const ssize_t n = read(read_end_, chunk, sizeof chunk);
    if (n <= 0) return;
    rest.append(chunk, static_cast<std::size_t>(n));
    for (auto end = rest.find('\n'); end != std::string::npos; end = rest.find('\n')) {
      take(rest.substr(0, end));
      rest.erase(0, end + 1);
    }
  }
}

void StdoutTap::take(const std::string& text) {
  if (text.empty()) return;
  if (text[0] != kMark) {
    line_(text);
    return;
  }
  const std::lock_guard lock(mutex_);
  ++answered_;
  changed_.notify_all();
}

void StdoutTap::flush() {
  std::unique_lock lock(mutex_);
  const unsigned mine = ++asked_;
  std::fflush(stdout);
  std::fflush(stderr);
  const char mark[] = {'\n', kMark, '\n'};
  if (write(STDOUT_FILENO, mark, sizeof mark) != static_cast<ssize_t>(sizeof mark)) return;
  changed_.wait_for(lock, std::chrono::seconds(2), [&] { return answered_ >= mine; });
}

}  // namespace clothbench::android

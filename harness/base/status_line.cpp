#include "base/status_line.hpp"

#include <fcntl.h>
#include <fmt/format.h>
#include <sys/ioctl.h>
#include <unistd.h>

#include <cerrno>
#include <chrono>
#include <cstdio>

namespace clothbench {
namespace {

int kept = -1;  // descriptor of the original standard output during a redirection

double now_s() { return std::chrono::duration<double>(std::chrono::steady_clock::now().time_since_epoch()).count(); }

std::string left_for(double s) {
  constexpr double kFewSeconds = 100;
  return s < kFewSeconds ? fmt::format("about {:.0f} s left", s) : fmt::format("about {:.0f} min left", s / 60);
}

std::size_t columns() {
  constexpr std::size_t kUsual = 80;
  winsize size{};
  return ioctl(STDERR_FILENO, TIOCGWINSZ, &size) == 0 && size.ws_col > 1 ? size.ws_col : kUsual;
}

}  // namespace

StatusLine::StatusLine(bool enabled) : enabled_(enabled && isatty(STDERR_FILENO) != 0), start_s_(now_s()) {}

StatusLine::~StatusLine() {
  if (enabled_ && width_ > 0) fmt::print(stderr, "\r{:{}}\r", "", width_);
}

void StatusLine::show(const std::string& what, std::size_t done, std::size_t total) {
  if (!enabled_) return;
  const double elapsed_s = now_s() - start_s_;
  std::string line = total > 0 ? fmt::format("[{}/{}] {}", done, total, what) : what, eta;
  if (done > 0 && done < total)
    eta = "  " + left_for(elapsed_s / static_cast<double>(done) * static_cast<double>(total - done));
  // A line that wraps could not be overwritten.
  const std::size_t room = columns() - 1;
  if (line.size() + eta.size() > room) line.resize(room > eta.size() ? room - eta.size() : 0);
  line += eta;
  fmt::print(stderr, "\r{:<{}}", line, width_);
  std::fflush(stderr);
  width_ = line.size();
}

SummaryOutput::SummaryOutput() {
  std::fflush(stdout);
  kept = fcntl(STDOUT_FILENO, F_DUPFD_CLOEXEC, STDERR_FILENO + 1);
  if (kept >= 0) dup2(STDERR_FILENO, STDOUT_FILENO);
}

SummaryOutput::~SummaryOutput() {
  if (kept < 0) return;
  std::fflush(stdout);  // plugins use the C library's buffer
  dup2(kept, STDOUT_FILENO);
  close(kept);
  kept = -1;
}

void SummaryOutput::write(const std::string& text) {
  std::fflush(stdout);
  for (std::size_t at = 0; at < text.size();) {
    const ssize_t n = ::write(kept < 0 ? STDOUT_FILENO : kept, text.data() + at, text.size() - at);
    if (n < 0 && errno == EINTR) continue;
    if (n < 0) return;  // the reader has closed its end
    at += static_cast<std::size_t>(n);
  }
}

}  // namespace clothbench

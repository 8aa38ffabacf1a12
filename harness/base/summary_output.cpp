#include "base/summary_output.hpp"

#include <fcntl.h>
#include <unistd.h>

#include <cerrno>
#include <cstdio>

namespace clothbench {
namespace {

int kept = -1;  // the first standard output while another file has its number

}  // namespace

SummaryOutput::SummaryOutput() {
  std::fflush(stdout);
  kept = fcntl(STDOUT_FILENO, F_DUPFD_CLOEXEC, STDERR_FILENO + 1);
  if (kept >= 0) dup2(STDERR_FILENO, STDOUT_FILENO);
}

SummaryOutput::~SummaryOutput() {
  if (kept < 0) return;
  std::fflush(stdout);  // a plugin shares the C library's buffer
  dup2(kept, STDOUT_FILENO);
  close(kept);
  kept = -1;
}

void SummaryOutput::write(const std::string& text) {
  std::fflush(stdout);
  for (std::size_t at = 0; at < text.size();) {
    const ssize_t n = ::write(kept < 0 ? STDOUT_FILENO : kept, text.data() + at, text.size() - at);
    if (n < 0 && errno == EINTR) continue;
    if (n < 0) return;  // its reader has gone
    at += static_cast<std::size_t>(n);
  }
}

}  // namespace clothbench

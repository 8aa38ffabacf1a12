#include "runner/child.hpp"

#include <sys/socket.h>
#include <unistd.h>

#include <chrono>

#include "clothbench/error.hpp"
#include "runner/interrupt.hpp"

namespace clothbench {

Child::Child(const std::vector<std::string>& argv, const std::filesystem::path& log)
    : process_(argv, {.socket = true, .out = log, .err = log}) {}

std::optional<ChildEnd> Child::ask(const std::string& line, double limit_s) {
  using namespace std::chrono_literals;
  const auto began = std::chrono::steady_clock::now();
  const auto asked = [&](ChildEnd end) {
    end.wall_s = std::chrono::duration<double>(std::chrono::steady_clock::now() - began).count();
    return end;
  };
  bool gone = !process_.write(line + "\n");
  while (!gone) {
    char answer = 0;
    const ChildProcess::Heard heard = process_.read(answer, 50ms);
    if (heard == ChildProcess::Heard::Byte) return std::nullopt;
    gone = heard == ChildProcess::Heard::End;
    if (interrupt_requested()) {
      process_.kill();
      stop_if_interrupted(kRunsKept);
    }
    if (limit_s > 0 && asked({}).wall_s > limit_s) return asked(process_.kill());
  }
  return asked(process_.wait());
}

std::optional<std::string> next_line_from_parent() {
  std::string line;
  for (char c = 0; read(STDIN_FILENO, &c, 1) == 1; line += c)
    if (c == '\n') return line;
  return std::nullopt;
}

void answer_parent() { static_cast<void>(send(STDIN_FILENO, "\n", 1, MSG_NOSIGNAL)); }

std::filesystem::path own_program() {
#ifdef __ANDROID__
  // An app's process is the system's program, not this one.
  throw Error("the app cannot start child processes, which this study needs; use the plain executable");
#else
  return std::filesystem::read_symlink("/proc/self/exe");
#endif
}

}  // namespace clothbench

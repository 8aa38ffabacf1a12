#pragma once
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "base/child_process.hpp"

namespace clothbench {

/// A child process that reads requests line by line from its standard input, a socket, and answers each with an end of
/// line on the same socket.
class Child {
 public:
  /// Starts argv[0] (a path) with its output in `log`. Throws Error if it cannot be started.
  Child(const std::vector<std::string>& argv, const std::filesystem::path& log);

  /// Sends a line and waits for the answer. Returns nothing if it came, or how the child ended instead, for example
  /// killed after `limit_s` (0 = never); the child is then gone. On Ctrl-C the child is killed and the interrupt
  /// thrown.
  std::optional<ChildEnd> ask(const std::string& line, double limit_s);

 private:
  ChildProcess process_;
};

/// Reads one line from the parent, or nothing after the parent has ended; and answers it.
std::optional<std::string> next_line_from_parent();
void answer_parent();

/// The child's side: calls `answer` for every line until there are no more.
template <class Answer>
void serve_parent(Answer&& answer) {
  while (const std::optional<std::string> line = next_line_from_parent()) {
    answer(*line);
    answer_parent();
  }
}

/// Path of this program's executable, for running it again. Throws Error in an app.
std::filesystem::path own_program();

}  // namespace clothbench

#pragma once
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "base/child_process.hpp"

namespace clothbench {

/// A program that is asked line by line on its standard input, a socket, and answers each with an end of line on the
/// same socket.
class Child {
 public:
  /// Starts argv[0] (a path), its output going to `log`. Throws Error if it cannot be started.
  Child(const std::vector<std::string>& argv, const std::filesystem::path& log);

  /// Sends a line and waits for the answer: nothing, or how the child ended instead, killed after `limit_s` (0 = never)
  /// among others. It is gone then. On Ctrl-C the child is killed and the interrupt thrown.
  std::optional<ChildEnd> ask(const std::string& line, double limit_s);

 private:
  ChildProcess process_;
};

/// One line from the parent, or nothing once it is gone; and the answer to it.
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

/// This program's own file, to be run again. Throws Error in an app.
std::filesystem::path own_program();

}  // namespace clothbench

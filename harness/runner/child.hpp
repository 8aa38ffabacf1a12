#pragma once
#include <filesystem>
#include <string>
#include <vector>

namespace clothbench {

/// How a child process ended.
struct ChildEnd {
  enum class How { Exited, Signalled, TimedOut };
  How how = How::Exited;
  int code = 0;  ///< exit status, or number of the signal
  double wall_s = 0;
  /// "signal 11 (Segmentation fault)", "exit status 3", "killed after 5 s"
  std::string text() const;
};

/// Runs a program (argv[0]: its path) with its output going to `log`, and kills it after `limit_s` (0 = never) or on
/// Ctrl-C, which then throws the interrupt. Throws Error if it cannot be started.
ChildEnd run_child(const std::vector<std::string>& argv, double limit_s, const std::filesystem::path& log);

/// This program's own file, to be run again. Throws Error in an app.
std::filesystem::path own_program();

}  // namespace clothbench

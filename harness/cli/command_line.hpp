#pragma once
#include <string>
#include <vector>

namespace clothbench {

/// The `clothbench` command: `words` are its arguments without the program's name. Prints, and returns the exit code
/// (see ExitCode); throws nothing. May be called repeatedly in one process, but not concurrently.
int run_command_line(const std::vector<std::string>& words);

}  // namespace clothbench

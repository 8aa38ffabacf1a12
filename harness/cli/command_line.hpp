#pragma once
#include <string>
#include <vector>

namespace clothbench {

/// The `clothbench` command: `words` are its arguments without the program's name. Prints, and returns the exit code
/// (see ExitCode); throws nothing. May be called again and again in one process, one call at a time.
int run_command_line(const std::vector<std::string>& words);

}  // namespace clothbench

#pragma once
#include <cstdlib>

namespace clothbench {

/// Environment variable with the libraries of solvers that a process knows by name: paths, separated by colons.
inline constexpr char kPluginsVariable[] = "CLOTHBENCH_PLUGINS";
inline constexpr char kInProcess[] = "CLOTHBENCH_IN_PROCESS";

/// Whether solvers run in this process and not in a child that they may crash: $CLOTHBENCH_IN_PROCESS is set, as
/// --in-process does. A debugger then sees them, and a crash ends the program. An app cannot start a child.
inline bool solvers_in_process() {
#ifdef __ANDROID__
  return true;
#else
  return std::getenv(kInProcess) != nullptr;
#endif
}
inline void run_solvers_in_process() { setenv(kInProcess, "1", 1); }

}  // namespace clothbench

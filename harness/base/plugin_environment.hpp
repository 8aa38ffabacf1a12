#pragma once

namespace clothbench {

/// Environment variable with the libraries of solvers that a process knows by name: paths, separated by colons.
inline constexpr char kPluginsVariable[] = "CLOTHBENCH_PLUGINS";

/// Whether plugins run in this process and not in a child that they may crash: $CLOTHBENCH_IN_PROCESS is set, as
/// --in-process does. A debugger then sees them, and a crash ends the program.
bool plugins_in_process();
void run_plugins_in_process();

}  // namespace clothbench

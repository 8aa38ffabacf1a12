#pragma once
#include <string>

#include "clothbench/solver.hpp"

namespace clothbench::plugin {

/// The solver in the shared library `path`, loaded once a process and never unloaded. Throws Error naming the file and
/// what is wrong with it: it does not load or crashes (found out in a child process), another version, sizes that do
/// not fit, a description that is not complete, a name that is taken.
const SolverEntry& load(const std::string& path);

/// A solver of a library that this process has loaded or that $CLOTHBENCH_PLUGINS names (paths, parted by colons), to
/// which `load` adds every path so that processes started from this one know it too. Null if there is none of that
/// name.
const SolverEntry* find(const std::string& name);

}  // namespace clothbench::plugin

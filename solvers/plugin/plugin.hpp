#pragma once
#include <string>

#include "clothbench/solver.hpp"

namespace clothbench::plugin {

/// The solver in the shared library `path`, loaded once per process and never unloaded. Throws Error with the file and
/// the reason: the library does not load or crashes (tried in a child process), its interface version or sizes differ,
/// its description is incomplete, or its name is taken.
const SolverEntry& load(const std::string& path);

/// A solver of a library that this process has loaded, or that $CLOTHBENCH_PLUGINS lists (paths separated by colons).
/// `load` adds every path to that variable, so that child processes find the solver too. Null if none has that name.
const SolverEntry* find(const std::string& name);

}  // namespace clothbench::plugin

#pragma once
#include <string>
#include <vector>

#include "clothbench/solver.hpp"

namespace clothbench {

/// Times the runs of a study under Google Benchmark, which prints the results. `words`: its --benchmark_… flags.
/// Returns false if a solver failed. Throws Error for an unknown word, and if no run matches.
bool bench(const std::string& study, const DeviceOptions&, std::vector<std::string> words);

}  // namespace clothbench
